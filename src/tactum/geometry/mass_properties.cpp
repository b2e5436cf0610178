#include "tactum/geometry/mass_properties.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "tactum/base/tolerances.h"
#include "tactum/geometry/hull.h"
#include "tactum/geometry/mesh_edges.h"
#include "tactum/geometry/mesh_report.h"

namespace tactum::inline v0_1 {
namespace {

/// Moments of order 0, 1, 2 about `origin`, signed: negative for a surface that is inside out.
struct Moments {
  double volume = 0.0;
  Vec3 first = Vec3::Zero();   ///< integral of x
  Mat3 second = Mat3::Zero();  ///< integral of x x^T
};

/// A tetrahedron (0, a, b, c) has volume det/6, first moment V (a+b+c)/4 and second moment
/// V/20 (s s^T + a a^T + b b^T + c c^T) with s = a + b + c.
Moments moments_about(const Vec3& origin, const TriangleMesh& mesh) {
  Moments sum;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]] - origin;
    const Vec3 b = mesh.vertices[t[1]] - origin;
    const Vec3 c = mesh.vertices[t[2]] - origin;
    const double volume = a.dot(b.cross(c)) / 6.0;
    const Vec3 s = a + b + c;
    sum.volume += volume;
    sum.first += volume / 4.0 * s;
    sum.second +=
        volume / 20.0 * (s * s.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose());
  }
  return sum;
}

/// The second moment of a volume's points about their centre [m^5].
Mat3 second_about(const Vec3& center, const Moments& moments) {
  return moments.second - moments.volume * center * center.transpose();
}

/// Whether moments about the middle of a box are those of a solid in it: its centre of mass is in the box,
/// and its second moments are positive. Those of a surface whose parts cancel need not be.
bool are_of_solid(const Moments& moments, const Aabb& box) {
  if (!(moments.volume > tolerances::kNoVolume * std::pow(box.diagonal(), 3))) return false;
  const Vec3 center = moments.first / moments.volume;
  if (!(center.cwiseAbs().array() <= 0.5 * (box.max - box.min).array()).all()) return false;
  return Eigen::LLT<Mat3>(second_about(center, moments)).info() == Eigen::Success;
}

MassProperties from_moments(const Moments& moments, const Vec3& origin, double density) {
  MassProperties out;
  out.volume = moments.volume;
  out.mass = density * moments.volume;
  const Vec3 center = moments.first / moments.volume;
  out.center = origin + center;
  const Mat3 second = density * second_about(center, moments);
  out.inertia = second.trace() * Mat3::Identity() - second;
  return out;
}

Vec3 middle(const TriangleMesh& mesh) { return bounds(mesh.vertices).center(); }

TriangleMesh surface_of(const Polytope& hull) {
  TriangleMesh mesh;
  mesh.vertices = hull.vertices;
  for (const Polytope::Face& face : hull.faces) {
    const int* loop = hull.face_vertices.data() + face.first;
    for (int i = 1; i + 1 < face.count; ++i) mesh.triangles.push_back({loop[0], loop[i], loop[i + 1]});
  }
  return mesh;
}

/// The mass of a box around the points, no side thinner than a thousandth of its diagonal.
MassProperties of_box(const TriangleMesh& mesh, double density) {
  constexpr double kThinnest = 1e-3;  // of the diagonal: a plate still has a mass
  const Aabb box = bounds(mesh.vertices);
  const Vec3 side = (box.max - box.min).cwiseMax(kThinnest * box.diagonal());
  MassProperties out;
  out.volume = side.prod();
  out.mass = density * out.volume;
  out.center = box.center();
  const Vec3 sq = side.cwiseProduct(side);
  out.inertia = (out.mass / 12.0 * (Vec3::Constant(sq.sum()) - sq)).asDiagonal();
  out.approximation = "The points lie in a plane: mass and inertia are those of the bounding box.";
  return out;
}

/// The mesh without its sheets: triangles with an edge of their own go, then those that this leaves with one.
TriangleMesh without_sheets(const TriangleMesh& mesh) {
  const std::vector<HalfEdge> sides = sorted_half_edges(mesh);
  std::vector<int> edge_of(sides.size());  // of each side of each triangle: where its edge begins in `sides`
  std::vector<int> left(sides.size(), 0);  // triangles at the edge
  std::vector<int> waiting;                // edges of one triangle
  for_each_edge(sides, [&](const HalfEdge* first, const HalfEdge* last) {
    const int edge = static_cast<int>(first - sides.data());
    for (const HalfEdge* side = first; side != last; ++side)
      edge_of[3 * side->triangle + side->corner] = edge;
    left[edge] = static_cast<int>(last - first);
    if (left[edge] == 1) waiting.push_back(edge);
  });
  std::vector<bool> gone(mesh.triangles.size(), false);
  while (!waiting.empty()) {
    const HalfEdge* side = sides.data() + waiting.back();
    waiting.pop_back();
    const HalfEdge& edge = *side;
    const HalfEdge* end = sides.data() + sides.size();
    while (side != end && side->same_edge(edge) && gone[side->triangle]) ++side;
    if (side == end || !side->same_edge(edge)) continue;  // its triangle went over another edge
    gone[side->triangle] = true;
    for (int corner = 0; corner < 3; ++corner)
      if (const int at = edge_of[3 * side->triangle + corner]; --left[at] == 1) waiting.push_back(at);
  }
  TriangleMesh out;
  out.vertices = mesh.vertices;
  for (std::size_t t = 0; t < gone.size(); ++t)
    if (!gone[t]) out.triangles.push_back(mesh.triangles[t]);
  return out;
}

double area_of(const TriangleMesh& mesh) {
  double twice = 0.0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3& a = mesh.vertices[t[0]];
    twice += (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a).norm();
  }
  return 0.5 * twice;
}

/// Of the solids of a mesh with sheets, where they are the larger part of its area: a small closed part says
/// nothing of the mass of a body whose own surface is open.
Result<MassProperties> of_solids_among_sheets(const TriangleMesh& mesh, double density) {
  constexpr double kLeastShare = 0.5;
  const TriangleMesh solids = without_sheets(mesh);
  if (area_of(solids) < kLeastShare * area_of(mesh))
    return Error{"sheets are the larger part of the mesh", "", "", ""};
  Result<MassProperties> out = mass_properties(solids, density);
  if (out) {
    out->approximation = fmt::format("Of the {} triangles {} bound no solid and have no mass.",
                                     mesh.triangles.size(), mesh.triangles.size() - solids.triangles.size());
  }
  return out;
}

}  // namespace

Result<MassProperties> mass_properties(const TriangleMesh& mesh, double density_kg_per_m3) {
  const MeshReport report = report_mesh(mesh);
  const char* what = "the solid has no mass properties";
  if (!report.balanced && !report.closed) {
    return Error{what,
                 std::to_string(report.boundary_edges) + " boundary and " +
                     std::to_string(report.non_manifold_edges) +
                     " non-manifold edges, the first at triangle " +
                     std::to_string(std::max(report.first_boundary, report.first_non_manifold)),
                 "a closed surface", "mesh"};
  }
  if (!report.balanced) {
    return Error{what,
                 std::to_string(report.misoriented_edges) + " edges where neighbours face opposite ways",
                 "triangles that all face outward", "mesh"};
  }
  if (!(report.volume > 0.0)) {
    return Error{what, "a signed volume of " + std::to_string(report.volume) + " m^3",
                 "a positive one: triangles counter-clockwise seen from outside", "mesh"};
  }
  const Vec3 origin = middle(mesh);
  const Moments moments = moments_about(origin, mesh);
  if (!are_of_solid(moments, report.box))
    return Error{
        what,
        fmt::format("a signed volume of {} m^3 whose centre or moments are those of no solid", report.volume),
        "a surface that encloses each point once", "mesh"};
  return from_moments(moments, origin, density_kg_per_m3);
}

MassProperties mass_properties_or_hull(const TriangleMesh& mesh, double density_kg_per_m3) {
  if (mesh.vertices.empty()) return {};
  if (Result<MassProperties> exact = mass_properties(mesh, density_kg_per_m3); exact) return *exact;
  TriangleMesh turned = mesh;
  for (Triangle& t : turned.triangles) std::swap(t[1], t[2]);
  if (Result<MassProperties> exact = mass_properties(turned, density_kg_per_m3); exact) {
    exact->approximation = "The normals point inward: the surface was turned round.";
    return *exact;
  }
  for (const TriangleMesh* faces : {&mesh, &std::as_const(turned)})
    if (Result<MassProperties> solids = of_solids_among_sheets(*faces, density_kg_per_m3); solids)
      return *solids;
  const Result<Polytope> hull = convex_hull(mesh.vertices);
  if (!hull || hull->flat) return of_box(mesh, density_kg_per_m3);
  const TriangleMesh surface = surface_of(*hull);
  const Vec3 origin = middle(surface);
  MassProperties out = from_moments(moments_about(origin, surface), origin, density_kg_per_m3);
  out.approximation = "The surface is not closed: mass and inertia are those of its convex hull.";
  return out;
}

}  // namespace tactum::inline v0_1
