#include "tactum/surface/triangle_pair.h"

#include <algorithm>

#include "tactum/base/tolerances.h"

namespace tactum::inline v0_1 {
namespace {

void keep_nearer(PointPair& best, const Vec3& p_a, const Vec3& p_b) noexcept {
  const double distance_sq = (p_a - p_b).squaredNorm();
  if (distance_sq < best.distance_sq) best = {distance_sq, p_a, p_b};
}

/// The foot of `point` on the segment from `start` along `d`, as a fraction in [0, 1].
double foot(const Vec3& point, const Vec3& start, const Vec3& d) noexcept {
  const double length_sq = d.squaredNorm();
  return length_sq > 0.0 ? std::clamp((point - start).dot(d) / length_sq, 0.0, 1.0) : 0.0;
}

/// Six times the volume of (p, q, a, b): swapping a and b turns the sign and keeps every bit.
double side_of(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b) noexcept {
  return (a - p).cross(b - p).dot(q - p);
}

/// Whether the segment pq meets the triangle. Its line passes inside when it has all sides on one hand.
bool segment_meets(const Vec3& p, const Vec3& q, const TrianglePoints& t) noexcept {
  const Vec3 normal = (t[1] - t[0]).cross(t[2] - t[0]);
  const double height_p = normal.dot(p - t[0]);
  const double height_q = normal.dot(q - t[0]);
  if ((height_p > 0.0 && height_q > 0.0) || (height_p < 0.0 && height_q < 0.0)) return false;
  if (height_p == 0.0 && height_q == 0.0) return false;  // in one plane: see the header
  const double s0 = side_of(p, q, t[0], t[1]);
  const double s1 = side_of(p, q, t[1], t[2]);
  const double s2 = side_of(p, q, t[2], t[0]);
  return (s0 >= 0.0 && s1 >= 0.0 && s2 >= 0.0) || (s0 <= 0.0 && s1 <= 0.0 && s2 <= 0.0);
}

/// Corners of `corners` over the inside of `t`; `swapped`: `corners` belongs to the second
/// triangle.
void corners_over(const TrianglePoints& corners, const TrianglePoints& t, bool swapped,
                  PointPair& best) noexcept {
  const Vec3 normal = (t[1] - t[0]).cross(t[2] - t[0]);
  const double length_sq = normal.squaredNorm();
  if (!(length_sq > 0.0)) return;  // no inside: its sides are all there is
  for (const Vec3& point : corners) {
    const double height = normal.dot(point - t[0]);
    if (height * height >= best.distance_sq * length_sq) continue;
    bool inside = true;
    for (std::size_t k = 0; k < 3 && inside; ++k) {
      const Vec3& from = t[k];
      inside = (t[(k + 1) % 3] - from).cross(point - from).dot(normal) >= 0.0;
    }
    if (!inside) continue;
    const Vec3 below = point - height / length_sq * normal;
    keep_nearer(best, swapped ? below : point, swapped ? point : below);
  }
}

}  // namespace

PointPair segment_distance(const Vec3& a0, const Vec3& a1, const Vec3& b0, const Vec3& b1) noexcept {
  const Vec3 da = a1 - a0;
  const Vec3 db = b1 - b0;
  const Vec3 across = da.cross(db);
  const double across_sq = across.squaredNorm();
  const double parallel_sq =
      da.squaredNorm() * db.squaredNorm() * tolerances::kParallelSine * tolerances::kParallelSine;
  PointPair best;
  if (across_sq > parallel_sq) {
    // The lines' nearest points; when they lie beyond an end, the foot on the other from the clamped one,
    // twice.
    const double s = std::clamp((b0 - a0).cross(db).dot(across) / across_sq, 0.0, 1.0);
    const double t = foot(a0 + s * da, b0, db);
    const Vec3 p_b = b0 + t * db;
    keep_nearer(best, a0 + foot(p_b, a0, da) * da, p_b);
    return best;
  }
  // Parallel, or one is a point: an end of one is among the nearest.
  for (const Vec3& a : {a0, a1}) keep_nearer(best, a, b0 + foot(a, b0, db) * db);
  for (const Vec3& b : {b0, b1}) keep_nearer(best, a0 + foot(b, a0, da) * da, b);
  return best;
}

bool triangles_cross(const TrianglePoints& a, const TrianglePoints& b) noexcept {
  for (std::size_t k = 0; k < 3; ++k) {
    if (segment_meets(a[k], a[(k + 1) % 3], b)) return true;
    if (segment_meets(b[k], b[(k + 1) % 3], a)) return true;
  }
  return false;
}

PointPair triangle_distance(const TrianglePoints& a, const TrianglePoints& b) noexcept {
  PointPair best;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const PointPair sides = segment_distance(a[i], a[(i + 1) % 3], b[k], b[(k + 1) % 3]);
      if (sides.distance_sq < best.distance_sq) best = sides;
    }
  }
  corners_over(a, b, false, best);
  corners_over(b, a, true, best);
  return best;
}

}  // namespace tactum::inline v0_1
