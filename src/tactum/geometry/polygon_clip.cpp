#include "tactum/geometry/polygon_clip.h"

namespace tactum::inline v0_1 {

std::vector<Vec3> face_corners(const Polytope& polytope, int face) {
  const Polytope::Face& loop = polytope.faces[face];
  std::vector<Vec3> corners;
  corners.reserve(static_cast<std::size_t>(loop.count));
  for (int i = 0; i < loop.count; ++i)
    corners.push_back(polytope.vertices[polytope.face_vertices[loop.first + i]]);
  return corners;
}

void keep_below(std::vector<Vec3>& polygon, const Vec3& normal, double offset) {
  std::vector<Vec3> kept;
  kept.reserve(polygon.size() + 1);
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3& p = polygon[i];
    const Vec3& q = polygon[(i + 1) % polygon.size()];
    const double at_p = normal.dot(p) - offset;
    const double at_q = normal.dot(q) - offset;
    if (at_p <= 0.0) kept.push_back(p);
    if ((at_p < 0.0 && at_q > 0.0) || (at_p > 0.0 && at_q < 0.0))
      kept.emplace_back(p + (q - p) * (at_p / (at_p - at_q)));
  }
  polygon = std::move(kept);
}

double polygon_area(const std::vector<Vec3>& polygon, const Vec3& normal) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
    sum += (polygon[i] - polygon[0]).cross(polygon[i + 1] - polygon[0]);
  return 0.5 * sum.dot(normal);
}

}  // namespace tactum::inline v0_1
