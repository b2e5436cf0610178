#include "tactum/referee/crossing.h"

#include "tactum/referee/exact_orientation.h"

namespace tactum::inline v0_1 {
namespace {

using Corners = std::array<Vec3, 3>;

Corners corners_of(const TriangleMesh& mesh, int triangle) {
  const Triangle& t = mesh.triangles[static_cast<std::size_t>(triangle)];
  return {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
}

/// Whether the open segment p q passes through the inside of a triangle.
bool passes_through(const Vec3& p, const Vec3& q, const Corners& t) {
  if (orientation(t[0], t[1], t[2], p) * orientation(t[0], t[1], t[2], q) >= 0) return false;
  const int side = orientation(p, q, t[0], t[1]);
  return side != 0 && orientation(p, q, t[1], t[2]) == side && orientation(p, q, t[2], t[0]) == side;
}

std::vector<Aabb> boxes_of(const TriangleMesh& mesh) {
  std::vector<Aabb> boxes;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    Aabb box;
    for (const Vec3& corner : corners_of(mesh, static_cast<int>(i))) box.extend(corner);
    boxes.push_back(box);
  }
  return boxes;
}

}  // namespace

CrossingMesh::CrossingMesh(const TriangleMesh& mesh) : mesh_(mesh), boxes_(boxes_of(mesh)) {}

bool cross_exactly(const Corners& a, const Corners& b) {
  for (std::size_t k = 0; k < 3; ++k)
    if (passes_through(a[k], a[(k + 1) % 3], b) || passes_through(b[k], b[(k + 1) % 3], a)) return true;
  return false;
}

std::vector<std::array<int, 2>> crossing_triangles(const CrossingMesh& a, const CrossingMesh& b,
                                                   const Pose& X_AB, std::size_t most) {
  std::vector<std::array<int, 2>> crossing;
  if (a.boxes().empty() || b.boxes().empty()) return crossing;
  for_each_pair_within(a.boxes(), b.boxes(), X_AB, 0.0, [&](int of_a, int of_b) {
    const Corners in_b = corners_of(b.mesh(), of_b);
    if (cross_exactly(corners_of(a.mesh(), of_a), {X_AB * in_b[0], X_AB * in_b[1], X_AB * in_b[2]}))
      crossing.push_back({of_a, of_b});
    return crossing.size() < most;
  });
  return crossing;
}

}  // namespace tactum::inline v0_1
