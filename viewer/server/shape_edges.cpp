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

std::vector<Aabb> boxes_of(const Part& part) {
  std::vector<Aabb> boxes;
  for (const Polytope& piece : part.pieces) boxes.push_back(bounds(piece.vertices));
  return boxes;
}

std::vector<DrawnEdge> edges_of_solids(const Part& part) {
  const std::vector<Aabb> boxes = boxes_of(part);
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
      edges.push_back({tail, head, EdgeKind::kSharp});
    }
  }
  return edges;
}

std::vector<DrawnEdge> edges_of_surface(const Part& part) {
  const TriangleMesh& mesh = part.surface;
  const auto normal = [&](int triangle) { return triangle_normal(mesh, static_cast<std::size_t>(triangle)); };
  const double flattest = std::cos(kDrawnBend_rad);
  std::vector<DrawnEdge> edges;
  const std::vector<HalfEdge> sides = sorted_half_edges(mesh);
  for_each_edge(sides, [&](const HalfEdge* first, const HalfEdge* last) {
    const Vec3& tail = mesh.vertices[static_cast<std::size_t>(first->low)];
    const Vec3& head = mesh.vertices[static_cast<std::size_t>(first->high)];
    if (last - first != 2) {
      edges.push_back({tail, head, last - first == 1 ? EdgeKind::kOpen : EdgeKind::kCrowded});
      return;
    }
    const Vec3 here = normal(first[0].triangle);
    if (here.dot(normal(first[1].triangle)) > flattest) return;
    const Triangle& beyond = mesh.triangles[static_cast<std::size_t>(first[1].triangle)];
    const Vec3& far = mesh.vertices[static_cast<std::size_t>(beyond[(first[1].corner + 2) % 3])];
    edges.push_back({tail, head, here.dot(far - tail) > 0.0 ? EdgeKind::kReflex : EdgeKind::kSharp});
  });
  return edges;
}

}  // namespace

std::vector<DrawnEdge> edges_to_draw(const Part& part) {
  if (part.surface.triangles.size() > kMostDrawn) return {};
  return part.is_surface() ? edges_of_surface(part) : edges_of_solids(part);
}

std::vector<bool> covered_triangles(const Part& part) {
  std::vector<bool> covered;
  if (part.pieces.size() < 2 || part.surface.triangles.size() > kMostDrawn) {
    covered.resize(part.surface.triangles.size(), false);
    return covered;
  }
  constexpr double kTowardsCorner = 0.9;
  const std::vector<Aabb> boxes = boxes_of(part);
  const double aside = kAside * bounds(part.surface.vertices).diagonal();
  for (std::size_t i = 0; i < part.pieces.size(); ++i) {
    const Polytope& piece = part.pieces[i];
    for (const Polytope::Face& face : piece.faces) {
      const int* loop = piece.face_vertices.data() + face.first;
      const auto corner = [&](int k) { return piece.vertices[static_cast<std::size_t>(loop[k])]; };
      for (int t = 1; t + 1 < face.count; ++t) {
        const Vec3 middle = (corner(0) + corner(t) + corner(t + 1)) / 3.0;
        bool all = true;
        for (const Vec3& towards : {middle, corner(0), corner(t), corner(t + 1)}) {
          const Vec3 point = middle + kTowardsCorner * (towards - middle) + aside * face.normal;
          all = all && filled_by_another(part, boxes, i, point);
        }
        covered.push_back(all);
      }
    }
  }
  return covered;
}

}  // namespace tactum
