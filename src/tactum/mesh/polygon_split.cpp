#include "tactum/mesh/polygon_split.h"

#include <cmath>

#include "tactum/base/tolerances.h"

namespace tactum::inline v0_1::detail {
namespace {

double turn(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b.x() - a.x()) * (c.y() - b.y()) - (b.y() - a.y()) * (c.x() - b.x());
}

/// Normal of the mean plane, of length twice the projected area [Newell].
Vec3 newell_normal(const std::vector<Vec3>& vertices, const std::vector<int>& corners) {
  Vec3 normal = Vec3::Zero();
  const Vec3& origin = vertices[corners[0]];
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    normal += (vertices[corners[i]] - origin).cross(vertices[corners[i + 1]] - origin);
  }
  return normal;
}

/// The corners along two axes of the mean plane, counter-clockwise; empty when the polygon has no area.
std::vector<Vec2> flattened(const std::vector<Vec3>& vertices, const std::vector<int>& corners) {
  const Vec3 normal = newell_normal(vertices, corners);
  double size_sq = 0.0;
  for (int corner : corners)
    size_sq = std::max(size_sq, (vertices[corner] - vertices[corners[0]]).squaredNorm());
  if (!(normal.norm() > tolerances::kDegenerateTriangle * size_sq)) return {};
  const Vec3 n = normal.normalized();
  const Vec3 u = any_orthogonal(n);
  const Vec3 v = n.cross(u);
  std::vector<Vec2> points;
  points.reserve(corners.size());
  for (int corner : corners) {
    const Vec3 r = vertices[corner] - vertices[corners[0]];
    points.emplace_back(u.dot(r), v.dot(r));
  }
  return points;
}

/// Every corner turns left (or not at all), and once round in all: a star polygon turns more than once.
bool is_convex(const std::vector<Vec2>& points, double tolerance) {
  const std::size_t n = points.size();
  double total = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2& a = points[i];
    const Vec2& b = points[(i + 1) % n];
    const Vec2& c = points[(i + 2) % n];
    const double t = turn(a, b, c);
    if (t < -tolerance) return false;
    total += std::atan2(t, (b - a).dot(c - b));
  }
  return total < 3.0 * kPi;
}

bool inside(const Vec2& p, const Vec2& a, const Vec2& b, const Vec2& c) {
  return turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
}

/// Whether the corner at `i` can be cut off: it turns left and no other corner lies in its triangle.
bool is_ear(const std::vector<Vec2>& points, const std::vector<int>& ring, std::size_t i) {
  const std::size_t n = ring.size();
  const int previous = ring[(i + n - 1) % n];
  const int next = ring[(i + 1) % n];
  const Vec2& a = points[previous];
  const Vec2& b = points[ring[i]];
  const Vec2& c = points[next];
  if (turn(a, b, c) <= 0.0) return false;
  for (int other : ring) {
    if (other == previous || other == ring[i] || other == next) continue;
    const Vec2& p = points[other];
    if (p == a || p == b || p == c) continue;  // a slit's twin
    if (inside(p, a, b, c)) return false;
  }
  return true;
}

void clip_ears(const std::vector<Vec2>& points, const std::vector<int>& corners,
               std::vector<Triangle>& triangles) {
  std::vector<int> ring(corners.size());
  for (std::size_t i = 0; i < ring.size(); ++i) ring[i] = static_cast<int>(i);
  std::size_t at = 0;
  std::size_t refused = 0;
  while (ring.size() > 3) {
    const std::size_t n = ring.size();
    at %= n;
    if (!is_ear(points, ring, at) && refused < n) {  // after a whole round without an ear, cut any corner
      ++at;
      ++refused;
      continue;
    }
    triangles.push_back({corners[ring[(at + n - 1) % n]], corners[ring[at]], corners[ring[(at + 1) % n]]});
    ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(at));
    refused = 0;
  }
  triangles.push_back({corners[ring[0]], corners[ring[1]], corners[ring[2]]});
}

}  // namespace

SplitKind split_polygon(const std::vector<Vec3>& vertices, const std::vector<int>& corners,
                        std::vector<Triangle>& triangles) {
  const std::vector<Vec2> points = corners.size() > 3 ? flattened(vertices, corners) : std::vector<Vec2>{};
  double extent = 0.0;
  for (const Vec2& point : points) extent = std::max(extent, point.squaredNorm());
  if (points.empty() || is_convex(points, tolerances::kPolygonTurn * extent)) {
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
      triangles.push_back({corners[0], corners[i], corners[i + 1]});
    }
    return SplitKind::kConvex;
  }
  if (corners.size() > kMaxConcaveCorners) return SplitKind::kFailed;
  clip_ears(points, corners, triangles);
  return SplitKind::kConcave;
}

}  // namespace tactum::inline v0_1::detail
