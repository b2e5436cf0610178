#include "viewer/server/shape_edges.h"

#include <algorithm>
#include <cmath>

#include "tactum/geometry/mesh_edges.h"

namespace tactum {
namespace {

constexpr double kAside = 0.001;  // of the part's size: how far beyond a face is looked

bool contains(const Polytope& piece, const Vec3& point) {
  return std::all_of(piece.faces.begin(), piece.faces.end(),
                     [&](const Polytope::Face& face) { return face.normal.dot(point) < face.offset; });
}

/// Whether another piece than `own` fills the place.
bool filled_by_another(const Part& part, const std::vector<Aabb>& boxes, std::size_t own, const Vec3& point) {
  for (std::size_t i = 0; i < part.pieces.size(); ++i) {
    if (i == own || (point.array() < boxes[i].min.array()).any() ||
        (point.array() > boxes[i].max.array()).any())
      continue;
    if (contains(part.pieces[i], point)) return true;
  }
  return false;
}

std::vector<DrawnEdge> edges_of_solids(const Part& part) {
  std::vector<Aabb> boxes;
  for (const Polytope& piece : part.pieces) boxes.push_back(bounds(piece.vertices));
  const double aside = kAside * bounds(part.surface.vertices).diagonal();
  const double flattest = std::cos(kDrawnBend_rad);
  std::vector<DrawnEdge> edges;
  for (std::size_t i = 0; i < part.pieces.size(); ++i) {
    const Polytope& piece = part.pieces[i];
    for (const Polytope::Edge& edge : piece.edges) {
      const Vec3& left = piece.faces[static_cast<std::size_t>(edge.left)].normal;
      const Vec3& right = piece.faces[static_cast<std::size_t>(edge.right)].normal;
      if (left.dot(right) > flattest) continue;
      const Vec3& tail = piece.vertices[static_cast<std::size_t>(edge.tail)];
      const Vec3& head = piece.vertices[static_cast<std::size_t>(edge.head)];
      const Vec3 middle = 0.5 * (tail + head);
      const Vec3 step = aside * (left - right).normalized();
      if (filled_by_another(part, boxes, i, middle + step) ||
          filled_by_another(part, boxes, i, middle - step))
        continue;
      edges.push_back({tail, head});
    }
  }
  return edges;
}

std::vector<DrawnEdge> edges_of_surface(const Part& part) {
  const TriangleMesh& mesh = part.surface;
  const auto normal = [&](int triangle) {
    const Triangle& t = mesh.triangles[static_cast<std::size_t>(triangle)];
    const Vec3& a = mesh.vertices[static_cast<std::size_t>(t[0])];
    return (mesh.vertices[static_cast<std::size_t>(t[1])] - a)
        .cross(mesh.vertices[static_cast<std::size_t>(t[2])] - a)
        .normalized();
  };
  const double flattest = std::cos(kDrawnBend_rad);
  std::vector<DrawnEdge> edges;
  const std::vector<HalfEdge> sides = sorted_half_edges(mesh);
  for_each_edge(sides, [&](const HalfEdge* first, const HalfEdge* last) {
    if (last - first == 2 && normal(first[0].triangle).dot(normal(first[1].triangle)) > flattest) return;
    edges.push_back({mesh.vertices[static_cast<std::size_t>(first->low)],
                     mesh.vertices[static_cast<std::size_t>(first->high)]});
  });
  return edges;
}

}  // namespace

std::vector<DrawnEdge> edges_to_draw(const Part& part) {
  if (part.surface.triangles.size() > kMostDrawn) return {};
  return part.one_sided ? edges_of_surface(part) : edges_of_solids(part);
}

}  // namespace tactum
