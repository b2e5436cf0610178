/// tactum.Simulation: a scene or a world that Python steps, or lets C++ step along a motion.

#include <pybind11/stl.h>

#include "stepping.h"

namespace tactum::python {
namespace {

using namespace pybind11::literals;

ContactRecord contact_record(const StepContact& contact) {
  ContactRecord out{};
  out.body_a = contact.body_a;
  out.body_b = contact.body_b;
  out.piece_a = contact.piece_a;
  out.piece_b = contact.piece_b;
  out.kind_a = static_cast<std::int32_t>(contact.a.kind);
  out.feature_a = contact.a.index;
  out.kind_b = static_cast<std::int32_t>(contact.b.kind);
  out.feature_b = contact.b.index;
  std::copy_n(contact.p_W.data(), 3, out.point);
  std::copy_n(contact.n_W.data(), 3, out.normal);
  out.distance_m = contact.distance_m;
  out.normal_force_N = contact.force_N;
  out.friction_N = contact.friction_N;
  out.friction_coefficient = contact.friction_coefficient;
  out.cone_used = contact.cone_used;
  out.grip = static_cast<std::int32_t>(contact.grip);
  out.patch = contact.patch;
  out.residual_m = contact.residual_m;
  return out;
}

py::array contacts_of(SteppedScene& scene) {
  const std::vector<StepContact>& contacts = scene.contacts();
  py::array_t<ContactRecord> out(static_cast<py::ssize_t>(contacts.size()));
  ContactRecord* record = out.mutable_data();
  for (const StepContact& contact : contacts) *record++ = contact_record(contact);
  return out;
}

Wrench step_released(SteppedScene& scene, const DeviceSample& sample) {
  const py::gil_scoped_release released;
  return scene.step(sample);
}

py::tuple after_step(SteppedScene& scene, const Wrench& F_D) {
  return py::make_tuple(array_of(F_D), contacts_of(scene));
}

py::tuple step_pose(SteppedScene& scene, const Array& X_DH) {
  DeviceSample sample;
  sample.X_DH = pose_of(X_DH, "X_DH");
  sample.valid = true;
  return after_step(scene, step_released(scene, sample));
}

/// The wrench of every frame of a motion, without Python in between.
Array run_along(SteppedScene& scene, const Array& X_DH) {
  if (X_DH.ndim() != 3 || X_DH.shape(1) != 4 || X_DH.shape(2) != 4)
    throw Refusal({"poses have another shape", shape_of(X_DH), "(n, 4, 4)", "X_DH"});
  Array out({X_DH.shape(0), py::ssize_t{6}});
  double* wrench = out.mutable_data();
  const double* n = X_DH.data();
  const py::gil_scoped_release released;
  DeviceSample sample;
  sample.valid = true;
  for (py::ssize_t i = 0; i < X_DH.shape(0); ++i, n += 16, wrench += 6) {
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) sample.X_DH.R(row, column) = n[4 * row + column];
      sample.X_DH.p[row] = n[4 * row + 3];
    }
    put(scene.step(sample), wrench);
  }
  return out;
}

DeviceSample read_hand(SteppedScene& scene) {
  DeviceSample sample;
  const py::gil_scoped_release released;
  if (!scene.hand().read(scene.next_time_s(), sample)) sample.valid = false;
  return sample;
}

/// The wrench of every frame in which the scene's own hand leads it, and the hand's poses.
py::tuple follow_hand(SteppedScene& scene, std::uint64_t frames) {
  Array wrenches({static_cast<py::ssize_t>(frames), py::ssize_t{6}});
  Array poses({static_cast<py::ssize_t>(frames), py::ssize_t{4}, py::ssize_t{4}});
  double* wrench = wrenches.mutable_data();
  double* pose = poses.mutable_data();
  {
    const py::gil_scoped_release released;
    DeviceSample sample;
    for (std::uint64_t i = 0; i < frames; ++i, wrench += 6, pose += 16) {
      if (!scene.hand().read(scene.next_time_s(), sample)) sample.valid = false;
      const Wrench F_D = scene.step(sample);
      scene.hand().write(F_D);
      put(F_D, wrench);
      put(sample.X_DH, pose);
    }
  }
  return py::make_tuple(wrenches, poses);
}

Array poses_of(const SteppedScene& scene) {
  const std::vector<Pose>& poses = scene.simulation().bodies().X_WB;
  Array out({static_cast<py::ssize_t>(poses.size()), py::ssize_t{4}, py::ssize_t{4}});
  double* number = out.mutable_data();
  for (const Pose& X_WB : poses) {
    put(X_WB, number);
    number += 16;
  }
  return out;
}

Array twists_of(const SteppedScene& scene) {
  const std::vector<Twist>& twists = scene.simulation().bodies().V_WB;
  Array out({static_cast<py::ssize_t>(twists.size()), py::ssize_t{6}});
  double* number = out.mutable_data();
  for (const Twist& V : twists) {
    put(Wrench{V.v, V.w}, number);
    number += 6;
  }
  return out;
}

py::dict report_of(const SteppedScene& scene) {
  const FrameReport& report = scene.simulation().report();
  return py::dict("index"_a = report.index, "time_s"_a = static_cast<double>(report.index) / scene.rate_Hz(),
                  "flags"_a = report.flags, "safety"_a = report.safety,
                  "grasped_body"_a = report.grasped_body, "penetrating"_a = report.penetrating,
                  "min_distance_m"_a = report.min_distance_m, "X_WH"_a = array_of(report.X_WH),
                  "X_WH_proxy"_a = array_of(report.X_WH_proxy), "F_W_contacts"_a = array_of(report.restoring),
                  "F_W_felt"_a = array_of(report.coupling), "solver_iterations"_a = report.solver_iterations,
                  "exact_tests"_a = report.tests());
}

std::vector<std::string> names_of(const SteppedScene& scene) {
  std::vector<std::string> names;
  for (const Body& body : scene.simulation().world().bodies) names.push_back(body.name);
  return names;
}

/// Vertices in the body's frame and triangles; copies.
py::tuple mesh_of_body(const SteppedScene& scene, std::size_t body) {
  const std::vector<Body>& bodies = scene.simulation().world().bodies;
  if (body >= bodies.size()) throw py::index_error("there is no body of this number");
  const TriangleMesh& mesh = bodies[body].part->surface;
  Array vertices({static_cast<py::ssize_t>(mesh.vertices.size()), py::ssize_t{3}});
  py::array_t<std::int32_t> triangles({static_cast<py::ssize_t>(mesh.triangles.size()), py::ssize_t{3}});
  std::copy_n(mesh.vertices.front().data(), 3 * mesh.vertices.size(), vertices.mutable_data());
  std::copy_n(mesh.triangles.front().data(), 3 * mesh.triangles.size(), triangles.mutable_data());
  return py::make_tuple(vertices, triangles);
}

std::unique_ptr<SteppedScene> open_scene_of(const std::string& scene, const std::string& device,
                                            const std::string& grip, const std::string& response,
                                            const std::string& settings, double rate_Hz) {
  const py::gil_scoped_release released;
  return or_raise(SteppedScene::open(scene, {device, grip, response, settings, rate_Hz}));
}

void bind_samples(py::module_& module) {
  py::class_<DeviceSample>(module, "Sample", "What a device measures in a frame.")
      .def(py::init([](const Array& X_DH, std::uint32_t buttons) {
             DeviceSample sample;
             sample.X_DH = pose_of(X_DH, "X_DH");
             sample.buttons = buttons;
             sample.valid = true;
             return sample;
           }),
           "X_DH"_a, "buttons"_a = 0)
      .def_property_readonly("X_DH", [](const DeviceSample& sample) { return array_of(sample.X_DH); })
      .def_property_readonly("V_DH",
                             [](const DeviceSample& sample) {
                               return array_of(Wrench{sample.V_DH.v, sample.V_DH.w});
                             })
      .def_readonly("buttons", &DeviceSample::buttons)
      .def_readonly("valid", &DeviceSample::valid);
}

}  // namespace

void bind_simulations(py::module_& module) {
  PYBIND11_NUMPY_DTYPE(ContactRecord, body_a, body_b, piece_a, piece_b, kind_a, feature_a, kind_b, feature_b,
                       point, normal, distance_m, normal_force_N, friction_N, friction_coefficient, cone_used,
                       grip, patch, residual_m);
  module.attr("contact_dtype") = py::dtype::of<ContactRecord>();
  bind_samples(module);
  py::class_<SteppedScene>(module, "Simulation", "A scene or a world that its caller steps.")
      .def_static("_open", &open_scene_of, "scene"_a, "device"_a, "grip"_a, "response"_a, "settings"_a,
                  "rate_Hz"_a)
      .def("step", &step_pose, "X_DH"_a)
      .def(
          "step",
          [](SteppedScene& scene, const DeviceSample& sample) {
            return after_step(scene, step_released(scene, sample));
          },
          "sample"_a)
      .def("run", &run_along, "X_DH"_a)
      .def("open_hand", [](SteppedScene& scene) { or_raise(scene.hand().open()); })
      .def("read_hand", &read_hand)
      .def(
          "write_hand",
          [](SteppedScene& scene, const Array& F_D) { return scene.hand().write(wrench_of(F_D, "F_D")); },
          "F_D"_a)
      .def("close_hand", [](SteppedScene& scene) { scene.hand().close(); })
      .def("follow_hand", &follow_hand, "frames"_a)
      .def_property_readonly("hand_frames", &SteppedScene::frames_of_hand)
      .def_property_readonly("device", [](const SteppedScene& scene) { return scene.hand().info().name; })
      .def_property_readonly("contacts", &contacts_of)
      .def_property_readonly("X_WB", &poses_of)
      .def_property_readonly("V_WB", &twists_of)
      .def_property_readonly("report", &report_of)
      .def_property_readonly("bodies", &names_of)
      .def("body_mesh", &mesh_of_body, "body"_a)
      .def_property_readonly("name", &SteppedScene::name)
      .def_property_readonly("frames",
                             [](const SteppedScene& scene) { return scene.simulation().next_index(); })
      .def_property_readonly("dt_s",
                             [](const SteppedScene& scene) { return scene.simulation().settings().dt_s; })
      .def_property_readonly("hash", [](const SteppedScene& scene) { return scene.record().hash(); });
}

}  // namespace tactum::python
