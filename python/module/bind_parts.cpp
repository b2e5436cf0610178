/// tactum.Part, tactum.Distance and the queries.

#include <pybind11/stl.h>

#include <memory>

#include "conversions.h"
#include "tactum/embedding/part_query.h"

namespace tactum::python {
namespace {

using PartPointer = std::shared_ptr<const QueriedPart>;

PrepareOptions part_options(const std::string& name, const std::string& unit, double scale,
                            const std::string& pieces, int close_holes, double density, int threads) {
  PrepareOptions options;
  options.name = name;
  options.unit = unit;
  options.scale = scale;
  options.pieces = pieces;
  options.close_holes = close_holes;
  options.density_kg_per_m3 = density;
  options.threads = threads;
  return options;
}

PartPointer load_queried(const std::string& path, const std::string& name, const std::string& unit,
                         double scale, const std::string& pieces, int close_holes, double density,
                         int threads) {
  const py::gil_scoped_release released;
  return or_raise(
      QueriedPart::load(path, part_options(name, unit, scale, pieces, close_holes, density, threads)));
}

TriangleMesh mesh_of(const Array& vertices, const py::array_t<std::int64_t, py::array::c_style>& triangles) {
  if (vertices.ndim() != 2 || vertices.shape(1) != 3)
    throw Refusal({"vertices have another shape", shape_of(vertices), "(n, 3)", "vertices"});
  if (triangles.ndim() != 2 || triangles.shape(1) != 3)
    throw Refusal({"triangles have another shape", std::to_string(triangles.ndim()) + " dimensions", "(n, 3)",
                   "triangles"});
  TriangleMesh mesh;
  for (py::ssize_t i = 0; i < vertices.shape(0); ++i)
    mesh.vertices.emplace_back(vertices.at(i, 0), vertices.at(i, 1), vertices.at(i, 2));
  const auto corner = [&](py::ssize_t i, py::ssize_t j) {
    const std::int64_t index = triangles.at(i, j);
    return index < 0 || index > std::numeric_limits<int>::max() ? -1 : static_cast<int>(index);
  };
  for (py::ssize_t i = 0; i < triangles.shape(0); ++i)
    mesh.triangles.push_back({corner(i, 0), corner(i, 1), corner(i, 2)});
  return mesh;
}

PartPointer make_queried(const Array& vertices,
                         const py::array_t<std::int64_t, py::array::c_style>& triangles,
                         const std::string& name, const std::string& unit, double scale,
                         const std::string& pieces, int close_holes, double density, int threads) {
  TriangleMesh mesh = mesh_of(vertices, triangles);
  const py::gil_scoped_release released;
  return or_raise(QueriedPart::from_mesh(
      std::move(mesh), part_options(name, unit, scale, pieces, close_holes, density, threads)));
}

/// A view that keeps its part alive and cannot be written to.
template <class T>
py::array view_of(const T* data, std::size_t rows, const py::object& owner) {
  py::array view(py::dtype::of<T>(), {static_cast<py::ssize_t>(rows), py::ssize_t{3}}, {}, data, owner);
  view.attr("setflags")(py::arg("write") = false);
  return view;
}

PartDistance clearance_at(const QueriedPart& a, const QueriedPart& b, const Array& X_WA, const Array& X_WB) {
  const Pose at_a = pose_of(X_WA, "X_WA"), at_b = pose_of(X_WB, "X_WB");
  or_raise(check_pose(at_a, "X_WA"));
  or_raise(check_pose(at_b, "X_WB"));
  const py::gil_scoped_release released;
  SurfacePairCache cache;
  return clearance(a, at_a, b, at_b, cache);
}

PartDistance distance_at(const QueriedPart& a, const QueriedPart& b, const Array& X_WA, const Array& X_WB) {
  const Pose at_a = pose_of(X_WA, "X_WA"), at_b = pose_of(X_WB, "X_WB");
  or_raise(check_pose(at_a, "X_WA"));
  or_raise(check_pose(at_b, "X_WB"));
  const py::gil_scoped_release released;
  return or_raise(signed_distance(a, at_a, b, at_b));
}

/// The pose number i of a stack of 4 x 4 matrices.
Pose pose_at(const Array& X, py::ssize_t i) {
  const double* n = X.data() + 16 * i;
  Pose out;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) out.R(row, column) = n[4 * row + column];
    out.p[row] = n[4 * row + 3];
  }
  return out;
}

Array clearances(const QueriedPart& a, const QueriedPart& b, const Array& X_AB) {
  if (X_AB.ndim() != 3 || X_AB.shape(1) != 4 || X_AB.shape(2) != 4)
    throw Refusal({"poses have another shape", shape_of(X_AB), "(n, 4, 4)", "X_AB"});
  const py::ssize_t count = X_AB.shape(0);
  for (py::ssize_t i = 0; i < count; ++i)
    or_raise(check_pose(pose_at(X_AB, i), ("X_AB[" + std::to_string(i) + "]").c_str()));
  Array out(count);
  double* numbers = out.mutable_data();
  const py::gil_scoped_release released;
  SurfacePairCache cache;
  for (py::ssize_t i = 0; i < count; ++i) numbers[i] = clearance(a, {}, b, pose_at(X_AB, i), cache).distance;
  return out;
}

void bind_distance(py::module_& module) {
  py::class_<PartDistance>(module, "Distance", "Where two parts stand to each other, in world axes.")
      .def_readonly("distance_m", &PartDistance::distance, "[m]")
      .def_property_readonly("p_a_W", [](const PartDistance& d) { return array_of(d.p_a_W); })
      .def_property_readonly("p_b_W", [](const PartDistance& d) { return array_of(d.p_b_W); })
      .def_property_readonly("n_BA_W", [](const PartDistance& d) { return array_of(d.n_BA_W); })
      .def_readonly("touching_pairs", &PartDistance::touching_pairs)
      .def_readonly("inside", &PartDistance::inside)
      .def_readonly("certified", &PartDistance::certified);
}

}  // namespace

void bind_parts(py::module_& module) {
  bind_distance(module);
  using namespace pybind11::literals;
  py::class_<QueriedPart, std::shared_ptr<QueriedPart>>(module, "Part", "A part, prepared once.")
      .def_static(
          "load",
          [](const std::string& path, const std::string& name, const std::string& unit, double scale,
             const std::string& pieces, int close_holes, double density, int threads) {
            return std::const_pointer_cast<QueriedPart>(
                load_queried(path, name, unit, scale, pieces, close_holes, density, threads));
          },
          "path"_a, py::kw_only(), "name"_a = "", "unit"_a = "auto", "scale"_a = 0.0, "pieces"_a = "auto",
          "close_holes"_a = 0, "density_kg_per_m3"_a = 1000.0, "threads"_a = 1)
      .def_static(
          "from_mesh",
          [](const Array& vertices, const py::array_t<std::int64_t, py::array::c_style>& triangles,
             const std::string& name, const std::string& unit, double scale, const std::string& pieces,
             int close_holes, double density, int threads) {
            return std::const_pointer_cast<QueriedPart>(
                make_queried(vertices, triangles, name, unit, scale, pieces, close_holes, density, threads));
          },
          "vertices"_a, "triangles"_a, py::kw_only(), "name"_a = "", "unit"_a = "auto", "scale"_a = 0.0,
          "pieces"_a = "auto", "close_holes"_a = 0, "density_kg_per_m3"_a = 1000.0, "threads"_a = 1)
      .def(
          "save",
          [](const QueriedPart& part, const std::string& path) { or_raise(save_part(path, part.file())); },
          "path"_a)
      .def_property_readonly("name", [](const QueriedPart& part) { return part.file().part.name; })
      .def_property_readonly("_report", [](const QueriedPart& part) { return part.file().report; })
      .def_property_readonly("pieces", [](const QueriedPart& part) { return part.file().part.pieces.size(); })
      .def_property_readonly("is_surface",
                             [](const QueriedPart& part) { return part.file().part.is_surface(); })
      .def_property_readonly("size_m", [](const QueriedPart& part) { return part.file().part.size; })
      .def_property_readonly("volume_m3",
                             [](const QueriedPart& part) { return part.file().part.mass.volume; })
      .def_property_readonly("mass_kg", [](const QueriedPart& part) { return part.file().part.mass.mass; })
      .def_property_readonly("density_kg_per_m3",
                             [](const QueriedPart& part) { return part.file().density_kg_per_m3; })
      .def_property_readonly("center_P", [](const QueriedPart& part) { return array_of(part.file().origin); })
      .def_property_readonly(
          "inertia_B", [](const QueriedPart& part) { return array_of(Mat3(part.file().part.mass.inertia)); })
      .def_property_readonly("remarks",
                             [](const QueriedPart& part) { return part.file().part.notes.remarks; })
      .def_property_readonly("made_as", [](const QueriedPart& part) { return part.file().part.notes.pieces; })
      .def_property_readonly("vertices",
                             [](const py::object& self) {
                               const TriangleMesh& mesh = self.cast<const QueriedPart&>().mesh();
                               return view_of(mesh.vertices.front().data(), mesh.vertices.size(), self);
                             })
      .def_property_readonly("triangles", [](const py::object& self) {
        const TriangleMesh& mesh = self.cast<const QueriedPart&>().mesh();
        return view_of(mesh.triangles.front().data(), mesh.triangles.size(), self);
      });
  module.def("clearance", &clearance_at, "a"_a, "b"_a, "X_WA"_a, "X_WB"_a);
  module.def("signed_distance", &distance_at, "a"_a, "b"_a, "X_WA"_a, "X_WB"_a);
  module.def("clearances", &clearances, "a"_a, "b"_a, "X_AB"_a);
}

}  // namespace tactum::python
