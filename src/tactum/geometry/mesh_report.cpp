#include "tactum/geometry/mesh_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tactum/base/tolerances.h"
#include "tactum/geometry/mesh_edges.h"
#include "tactum/geometry/weld.h"

namespace tactum::inline v0_1 {
namespace {

int count_duplicates(const TriangleMesh& mesh) {
  std::vector<Triangle> sorted = mesh.triangles;
  for (Triangle& triangle : sorted) std::sort(triangle.begin(), triangle.end());
  std::sort(sorted.begin(), sorted.end());
  return static_cast<int>(sorted.end() - std::unique(sorted.begin(), sorted.end()));
}

/// Edge counts; returns the number of edges.
int count_edges(const WeldedMesh& welded, const std::vector<HalfEdge>& sides, MeshReport& report) {
  int edges = 0;
  report.balanced = !sides.empty();
  for_each_edge(sides, [&](const HalfEdge* first, const HalfEdge* last) {
    ++edges;
    const auto forward = std::count_if(first, last, [](const HalfEdge& side) { return side.forward; });
    if (2 * forward != last - first) report.balanced = false;
    if (last - first == 1) {
      if (report.boundary_edges++ == 0) report.first_boundary = welded.source[first->triangle];
    } else if (last - first > 2) {
      if (report.non_manifold_edges++ == 0) report.first_non_manifold = welded.source[first->triangle];
    } else if (first->forward == first[1].forward) {
      ++report.misoriented_edges;
    }
  });
  return edges;
}

/// Counts the vertices that triangles use, and their connected sets.
void count_vertices(const TriangleMesh& mesh, MeshReport& report) {
  DisjointSets sets(static_cast<int>(mesh.vertices.size()));
  std::vector<bool> used(mesh.vertices.size(), false);
  for (const Triangle& t : mesh.triangles) {
    for (int corner : t) {
      used[corner] = true;
      sets.join(t[0], corner);
    }
  }
  for (int i = 0; i < static_cast<int>(mesh.vertices.size()); ++i) {
    if (!used[i]) continue;
    ++report.vertices;
    report.components += sets.find(i) == i ? 1 : 0;
  }
}

/// Whether, at every edge, the far corner of each triangle lies below the plane of the other.
bool all_edges_convex(const TriangleMesh& mesh, const std::vector<HalfEdge>& sides, double size) {
  bool convex = true;
  for_each_edge(sides, [&](const HalfEdge* first, const HalfEdge* last) {
    if (last - first != 2 || !convex) return;
    for (int k = 0; k < 2; ++k) {
      const Triangle& t = mesh.triangles[first[k].triangle];
      const HalfEdge& other = first[1 - k];
      const Vec3& a = mesh.vertices[t[0]];
      const Vec3 normal = (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a);
      if (has_no_area(a, mesh.vertices[t[1]], mesh.vertices[t[2]])) continue;
      const Vec3& far = mesh.vertices[mesh.triangles[other.triangle][(other.corner + 2) % 3]];
      if (normal.normalized().dot(far - a) > tolerances::kConvexMesh * size) convex = false;
    }
  });
  return convex;
}

/// Counts the edges of two triangles that agree, by the direction of their bend.
void count_bends(const TriangleMesh& mesh, const std::vector<HalfEdge>& sides, MeshReport& report) {
  const auto unit_normal = [&](const Triangle& t) {
    const Vec3& a = mesh.vertices[t[0]];
    return (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a).normalized();
  };
  const auto flat = [&](const Triangle& t) {
    return has_no_area(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]);
  };
  for_each_edge(sides, [&](const HalfEdge* first, const HalfEdge* last) {
    if (last - first != 2 || first[0].forward == first[1].forward) return;
    const HalfEdge& along = first[0].forward ? first[0] : first[1];
    const HalfEdge& against = first[0].forward ? first[1] : first[0];
    const Triangle& left = mesh.triangles[along.triangle];
    const Triangle& right = mesh.triangles[against.triangle];
    if (flat(left) || flat(right)) return;
    const Vec3 direction = (mesh.vertices[first->high] - mesh.vertices[first->low]).normalized();
    const Vec3 n = unit_normal(left);
    const Vec3 m = unit_normal(right);
    const double bend = std::atan2(direction.dot(n.cross(m)), n.dot(m));  // positive: bent outward
    if (bend > tolerances::kCoplanarMeshSine) ++report.convex_edges;
    if (bend < -tolerances::kCoplanarMeshSine) ++report.reflex_edges;
  });
}

void measure(const TriangleMesh& mesh, MeshReport& report) {
  report.box = bounds(mesh.vertices);
  const Vec3 origin = report.box.empty() ? Vec3::Zero() : report.box.center();
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]] - origin;
    const Vec3 b = mesh.vertices[t[1]] - origin;
    const Vec3 c = mesh.vertices[t[2]] - origin;
    report.volume += a.dot(b.cross(c)) / 6.0;
    report.area += 0.5 * (b - a).cross(c - a).norm();
  }
}

}  // namespace

MeshReport report_mesh(const TriangleMesh& mesh, double tolerance) {
  MeshReport report;
  const WeldedMesh welded = weld(mesh, {.tolerance = tolerance});
  report.triangles = static_cast<int>(mesh.triangles.size());
  report.index_degenerate = welded.report.index_degenerate;
  report.duplicate_triangles = count_duplicates(welded.mesh);
  for (std::size_t i = 0; i < welded.mesh.triangles.size(); ++i) {
    const Triangle& t = welded.mesh.triangles[i];
    const auto& v = welded.mesh.vertices;
    if (has_no_area(v[t[0]], v[t[1]], v[t[2]])) report.zero_area.push_back(welded.source[i]);
  }
  const std::vector<HalfEdge> sides = sorted_half_edges(welded.mesh);
  const int edges = count_edges(welded, sides, report);
  count_vertices(welded.mesh, report);
  count_bends(welded.mesh, sides, report);
  report.euler = report.vertices - edges + static_cast<int>(welded.mesh.triangles.size());
  report.closed = !welded.mesh.triangles.empty() && report.boundary_edges == 0 && report.manifold();
  report.oriented = report.misoriented_edges == 0;
  measure(welded.mesh, report);
  report.convex = report.closed && report.oriented && report.components == 1 && report.euler == 2 &&
                  report.volume > 0.0 && all_edges_convex(welded.mesh, sides, report.box.diagonal());
  return report;
}

UnitGuess guess_unit(const Aabb& box) {
  // Parts people hold and assemble are a few millimetres to a metre; the bounds separate the three readings
  // of a number.
  constexpr double kLargestInMetres = 2.0;
  constexpr double kLargestInInches = 12.0;
  const double d = box.diagonal();
  if (d < kLargestInMetres) {
    return {"metres", 1.0,
            fmt::format("The diagonal of {:.4g} is the size of a part in metres; in millimetres it would be "
                        "too small to hold.",
                        d)};
  }
  if (d < kLargestInInches) {
    return {"inches", 0.0254,
            fmt::format("The diagonal of {:.4g} is too large for metres and small for millimetres.", d),
            false};
  }
  return {"millimetres", 0.001,
          fmt::format("The diagonal of {:.4g} is the size of a part in millimetres.", d)};
}

std::string describe(const MeshReport& report) {
  const auto yes = [](bool value) { return value ? "yes" : "no"; };
  std::string text;
  text += fmt::format("triangles {}, vertices {} after welding, components {}\n", report.triangles,
                      report.vertices, report.components);
  text += fmt::format("closed {}, manifold {}, oriented {}, convex {}\n", yes(report.closed),
                      yes(report.manifold()), yes(report.oriented), yes(report.convex));
  text += fmt::format("edges: {} boundary, {} non-manifold, {} misoriented, {} convex, {} reflex\n",
                      report.boundary_edges, report.non_manifold_edges, report.misoriented_edges,
                      report.convex_edges, report.reflex_edges);
  text += fmt::format("degenerate triangles: {} with equal corners, {} without area, {} duplicates\n",
                      report.index_degenerate.size(), report.zero_area.size(), report.duplicate_triangles);
  text +=
      report.balanced
          ? fmt::format("volume {:.6g} m^3", report.volume)
          : fmt::format("volume not known before a repair (the triangles as they face sum up to {:.6g} m^3)",
                        report.volume);
  text += fmt::format(", area {:.6g} m^2\n", report.area);
  text += fmt::format("box {:.6g} {:.6g} {:.6g} ; {:.6g} {:.6g} {:.6g} m\n", report.box.min.x(),
                      report.box.min.y(), report.box.min.z(), report.box.max.x(), report.box.max.y(),
                      report.box.max.z());
  return text;
}

}  // namespace tactum::inline v0_1
