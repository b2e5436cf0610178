#include "tactum/collision/planar_patch.h"

#include <algorithm>
#include <cmath>

namespace tactum {
namespace {

double cross(const Vec2& a, const Vec2& b) noexcept { return a.x() * b.y() - a.y() * b.x(); }

}  // namespace

void clip_polygon(PatchPolygon& polygon, const Vec2& normal, double offset, PatchPolygon& scratch) noexcept {
  bool cut = false;
  for (const Vec2& x : polygon) cut |= normal.dot(x) > offset;
  if (!cut) return;
  scratch.clear();
  const std::size_t n = polygon.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2& a = polygon[i];
    const Vec2& b = polygon[i + 1 == n ? 0 : i + 1];
    const double ha = normal.dot(a) - offset;
    const double hb = normal.dot(b) - offset;
    if (ha <= 0.0) scratch.push_back(a);
    if ((ha < 0.0 && hb > 0.0) || (ha > 0.0 && hb < 0.0)) scratch.push_back(a + (b - a) * (ha / (ha - hb)));
  }
  std::swap(polygon, scratch);
}

void clip_polygon(PatchPolygon& polygon, const PatchPolygon& window, PatchPolygon& scratch) noexcept {
  const std::size_t n = window.size();
  for (std::size_t i = 0; i < n && !polygon.empty(); ++i) {
    const Vec2& a = window[i];
    const Vec2 side = window[i + 1 == n ? 0 : i + 1] - a;
    const Vec2 outward(side.y(), -side.x());
    clip_polygon(polygon, outward, outward.dot(a), scratch);
  }
}

double twice_area(const PatchPolygon& polygon) noexcept {
  double sum = 0.0;
  for (std::size_t i = 2; i < polygon.size(); ++i)
    sum += cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]);
  return sum;
}

PatchMoments moments_of(const PatchPolygon& polygon) noexcept {
  PatchMoments m;
  Vec2 first = Vec2::Zero();  // sums over the triangles of a fan at corner 0, about corner 0
  Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
  double twice = 0.0;
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    const Vec2 a = polygon[i - 1] - polygon[0];
    const Vec2 b = polygon[i] - polygon[0];
    const double weight = cross(a, b);
    const Vec2 sum = a + b;
    twice += weight;
    first += weight / 3.0 * sum;
    second += weight / 12.0 * (a * a.transpose() + b * b.transpose() + sum * sum.transpose());
  }
  m.area = 0.5 * twice;
  if (!(m.area > 0.0)) return m;
  const Vec2 c = first / twice;
  const Eigen::Matrix2d central = second / twice - c * c.transpose();
  m.centroid = polygon[0] + c;
  const double half_trace = 0.5 * (central(0, 0) + central(1, 1));
  const double half_difference = 0.5 * (central(0, 0) - central(1, 1));
  const double spread = std::hypot(half_difference, central(0, 1));
  const double angle = 0.5 * std::atan2(central(0, 1), half_difference);
  m.axis = {std::cos(angle), std::sin(angle)};
  m.major = std::max(0.0, half_trace + spread);
  m.minor = std::max(0.0, half_trace - spread);
  return m;
}

void PatchInterval::keep_below(double at0, double at1, double limit) noexcept {
  const double slope = at1 - at0;
  const double room = limit - at0;  // slope s <= room
  if (slope == 0.0) {
    if (room < 0.0) high = low - 1.0;
  } else if (slope > 0.0) {
    high = std::min(high, room / slope);
  } else {
    low = std::max(low, room / slope);
  }
}

}  // namespace tactum
