#include "step_mesh.h"

#include <fmt/format.h>

#include <BRepBndLib.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <Geom_Surface.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <STEPControl_Reader.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <memory>
#include <numeric>

namespace tactum {
namespace {

constexpr double kDefaultDeviation = 1e-4;  // share of the diagonal

/// A face's triangles, with the number of its first corner among all faces'.
struct FaceMesh {
  TopoDS_Face face;
  TopLoc_Location place;
  Handle(Poly_Triangulation) triangles;
  int first_corner = 0;
};

gp_Pnt corner_of(const FaceMesh& face, int node) {
  return face.triangles->Node(node).Transformed(face.place.Transformation());
}

/// Corners on a common edge, which every face has for itself, as one: the smallest number stands for all.
class CommonCorners {
 public:
  explicit CommonCorners(int count) : parent_(static_cast<std::size_t>(count)) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  int of(int corner) {
    while (at(corner) != corner) corner = at(corner) = at(at(corner));
    return corner;
  }
  void join(int a, int b) {
    a = of(a);
    b = of(b);
    at(std::max(a, b)) = std::min(a, b);
  }

 private:
  int& at(int corner) { return parent_[static_cast<std::size_t>(corner)]; }
  std::vector<int> parent_;
};

/// Both faces of an edge follow one division of it, corner by corner; so do edges that meet in a vertex.
void join_along_edges(const std::vector<FaceMesh>& faces, CommonCorners& corners) {
  TopTools_IndexedMapOfShape edges;
  TopTools_IndexedMapOfShape vertices;
  std::map<std::pair<int, int>, int> of_edge;  // edge and place on it, to a corner
  std::map<int, int> of_vertex;
  for (const FaceMesh& face : faces)
    for (TopExp_Explorer edge(face.face, TopAbs_EDGE); edge.More(); edge.Next()) {
      const TopoDS_Edge& on = TopoDS::Edge(edge.Current());
      const Handle(Poly_PolygonOnTriangulation) line =
          BRep_Tool::PolygonOnTriangulation(on, face.triangles, face.place);
      if (line.IsNull()) continue;
      const int number = edges.Add(on);
      const auto corner = [&](int place) { return face.first_corner + line->Node(place) - 1; };
      for (int place = 1; place <= line->NbNodes(); ++place)
        corners.join(of_edge.try_emplace({number, place}, corner(place)).first->second, corner(place));
      const bool backwards = on.Orientation() == TopAbs_REVERSED;
      for (TopExp_Explorer end(on, TopAbs_VERTEX); end.More(); end.Next()) {
        const bool at_start = (end.Current().Orientation() == TopAbs_FORWARD) != backwards;
        const int here = corner(at_start ? 1 : line->NbNodes());
        corners.join(of_vertex.try_emplace(vertices.Add(end.Current()), here).first->second, here);
      }
    }
}

Vec3 in_metres(const gp_Pnt& p) { return {p.X(), p.Y(), p.Z()}; }

/// How far the middles of a triangle and of its sides are from the surface point with their middle
/// parameters; an upper bound of their distance from the surface.
double deviation_of(const FaceMesh& face, const std::array<int, 3>& nodes, const Geom_Surface& surface) {
  double worst = 0.0;
  const auto consider = [&](std::initializer_list<int> which) {
    gp_XYZ middle(0, 0, 0);
    gp_XY parameter(0, 0);
    for (int i : which) {
      middle += corner_of(face, nodes[static_cast<std::size_t>(i)]).XYZ();
      parameter += face.triangles->UVNode(nodes[static_cast<std::size_t>(i)]).XY();
    }
    const double share = 1.0 / static_cast<double>(which.size());
    const gp_Pnt exact = surface.Value(parameter.X() * share, parameter.Y() * share);
    worst = std::max(worst, exact.Distance(gp_Pnt(middle * share)));
  };
  consider({0, 1, 2});
  consider({0, 1});
  consider({1, 2});
  consider({2, 0});
  return worst;
}

/// Appends the triangles of `faces` as one body.
void add_body(const std::vector<FaceMesh>& faces, bool solid, StepMesh& out) {
  const int corners = faces.back().first_corner + faces.back().triangles->NbNodes();
  CommonCorners common(corners);
  join_along_edges(faces, common);
  std::vector<int> vertex(static_cast<std::size_t>(corners), -1);
  StepBody body;
  body.first_triangle = static_cast<int>(out.mesh.triangles.size());
  body.faces = static_cast<int>(faces.size());
  body.solid = solid;
  for (const FaceMesh& face : faces) {
    for (int node = 1; node <= face.triangles->NbNodes(); ++node) {
      const int corner = face.first_corner + node - 1;
      if (common.of(corner) != corner) continue;
      vertex[static_cast<std::size_t>(corner)] = static_cast<int>(out.mesh.vertices.size());
      out.mesh.vertices.push_back(in_metres(corner_of(face, node)));
    }
    const Handle(Geom_Surface) surface = BRep_Tool::Surface(face.face);
    const bool backwards = face.face.Orientation() == TopAbs_REVERSED;
    for (int t = 1; t <= face.triangles->NbTriangles(); ++t) {
      std::array<int, 3> nodes{};
      face.triangles->Triangle(t).Get(nodes[0], nodes[1], nodes[2]);
      if (face.triangles->HasUVNodes() && !surface.IsNull())
        out.deviation_m = std::max(out.deviation_m, deviation_of(face, nodes, *surface));
      if (backwards) std::swap(nodes[1], nodes[2]);
      Triangle triangle{};
      for (std::size_t i = 0; i < 3; ++i)
        triangle[i] = vertex[static_cast<std::size_t>(common.of(face.first_corner + nodes[i] - 1))];
      // A degenerate edge (a cone's tip) joins corners.
      if (triangle[0] != triangle[1] && triangle[1] != triangle[2] && triangle[2] != triangle[0])
        out.mesh.triangles.push_back(triangle);
    }
  }
  body.triangles = static_cast<int>(out.mesh.triangles.size()) - body.first_triangle;
  out.bodies.push_back(body);
}

/// The faces of a solid or shell, triangulated.
Result<std::vector<FaceMesh>> faces_of(const TopoDS_Shape& shape, const std::string& path) {
  std::vector<FaceMesh> faces;
  int corners = 0;
  for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next()) {
    FaceMesh mesh;
    mesh.face = TopoDS::Face(face.Current());
    mesh.triangles = BRep_Tool::Triangulation(mesh.face, mesh.place);
    if (mesh.triangles.IsNull())
      return Error{"a face cannot be triangulated", fmt::format("face {} of a body", faces.size() + 1),
                   "a face with a closed border (heal the file in the program it came from)", path};
    mesh.first_corner = corners;
    corners += mesh.triangles->NbNodes();
    faces.push_back(mesh);
  }
  return faces;
}

Result<TopoDS_Shape> shape_in(const std::string& path) {
  // OpenCASCADE tells its progress on standard output, which is not ours to fill.
  Message::DefaultMessenger()->ChangePrinters().Clear();
  STEPControl_Reader reader;
  Interface_Static::SetCVal("xstep.cascade.unit", "M");
  if (reader.ReadFile(path.c_str()) != IFSelect_RetDone)
    return Error{"the file cannot be read", "no STEP file", "an ISO 10303-21 file (.step, .stp)", path};
  reader.TransferRoots();
  const TopoDS_Shape shape = reader.OneShape();
  if (shape.IsNull() || !TopExp_Explorer(shape, TopAbs_FACE).More())
    return Error{"there is nothing to triangulate", "a STEP file without faces",
                 "solids or shells (AP203, AP214 or AP242)", path};
  return shape;
}

}  // namespace

Result<StepMesh> read_step(const std::string& path, const StepOptions& options) try {
  const Result<TopoDS_Shape> shape = shape_in(path);
  if (!shape) return shape.error();
  StepMesh out;
  out.asked_deviation_m = options.deviation_m;
  if (!(out.asked_deviation_m > 0.0)) {
    Bnd_Box box;
    BRepBndLib::Add(*shape, box);
    out.asked_deviation_m = kDefaultDeviation * std::sqrt(box.SquareExtent());
  }
  const BRepMesh_IncrementalMesh mesher(*shape, out.asked_deviation_m, false, options.angle_rad, false);
  for (TopExp_Explorer solid(*shape, TopAbs_SOLID); solid.More(); solid.Next()) {
    const Result<std::vector<FaceMesh>> faces = faces_of(solid.Current(), path);
    if (!faces) return faces.error();
    if (!faces->empty()) add_body(*faces, true, out);
  }
  for (TopExp_Explorer shell(*shape, TopAbs_SHELL, TopAbs_SOLID); shell.More(); shell.Next()) {
    const Result<std::vector<FaceMesh>> faces = faces_of(shell.Current(), path);
    if (!faces) return faces.error();
    if (!faces->empty()) add_body(*faces, false, out);
  }
  if (out.bodies.empty())
    return Error{"there is nothing to triangulate", "faces that belong to no solid and no shell",
                 "solids or shells", path};
  return out;
} catch (const Standard_Failure& failure) {
  return Error{"OpenCASCADE gave up", failure.GetMessageString(), "a STEP file it can read", path};
}

Result<void> write_obj(const std::string& path, const StepMesh& step) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "w"), &std::fclose);
  if (!file) return Error{"the file cannot be written", "no access", "a folder that can be written to", path};
  fmt::print(file.get(), "# metres\n");
  for (const Vec3& p : step.mesh.vertices)
    fmt::print(file.get(), "v {:.17g} {:.17g} {:.17g}\n", p.x(), p.y(), p.z());
  for (std::size_t b = 0; b < step.bodies.size(); ++b) {
    const StepBody& body = step.bodies[b];
    fmt::print(file.get(), "o body_{}\n", b + 1);
    for (int t = body.first_triangle; t < body.first_triangle + body.triangles; ++t) {
      const Triangle& triangle = step.mesh.triangles[static_cast<std::size_t>(t)];
      fmt::print(file.get(), "f {} {} {}\n", triangle[0] + 1, triangle[1] + 1, triangle[2] + 1);
    }
  }
  if (std::fflush(file.get()) != 0 || std::ferror(file.get()) != 0)
    return Error{"the file cannot be written", "the device is full or gone", "room for it", path};
  return {};
}

}  // namespace tactum
