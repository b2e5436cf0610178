#pragma once
/// An indexed triangle mesh, as files hold it and parts are made of it.

#include <array>
#include <vector>

#include "tactum/math/types.h"

namespace tactum::inline v0_1 {

using Triangle = std::array<int, 3>;  ///< vertex indices, counter-clockwise seen from outside

struct TriangleMesh {
  std::vector<Vec3> vertices;  ///< [m]
  std::vector<Triangle> triangles;
};

/// An axis-aligned box. Empty until it holds a point.
struct Aabb {
  Vec3 min = Vec3::Constant(1e300);
  Vec3 max = Vec3::Constant(-1e300);

  void extend(const Vec3& point) {
    min = min.cwiseMin(point);
    max = max.cwiseMax(point);
  }
  void extend(const Aabb& box) {
    min = min.cwiseMin(box.min);
    max = max.cwiseMax(box.max);
  }
  bool empty() const { return min.x() > max.x(); }
  Vec3 center() const { return 0.5 * (min + max); }
  Vec3 half() const { return 0.5 * (max - min); }
  double diagonal() const { return empty() ? 0.0 : (max - min).norm(); }
  bool overlaps(const Aabb& b) const {
    return (min.array() <= b.max.array()).all() && (b.min.array() <= max.array()).all();
  }
};

/// Unit, outward; not a number for a triangle without an area.
inline Vec3 triangle_normal(const TriangleMesh& mesh, std::size_t triangle) {
  const Triangle& t = mesh.triangles[triangle];
  const Vec3& a = mesh.vertices[static_cast<std::size_t>(t[0])];
  const Vec3& b = mesh.vertices[static_cast<std::size_t>(t[1])];
  const Vec3& c = mesh.vertices[static_cast<std::size_t>(t[2])];
  return (b - a).cross(c - a).normalized();
}

inline Aabb bounds(const std::vector<Vec3>& points) {
  Aabb box;
  for (const Vec3& point : points) box.extend(point);
  return box;
}

}  // namespace tactum::inline v0_1
