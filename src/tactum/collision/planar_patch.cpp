#include "tactum/collision/planar_patch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "tactum/base/tolerances.h"

namespace tactum {
namespace {

double cross(const Vec2& a, const Vec2& b) noexcept { return a.x() * b.y() - a.y() * b.x(); }

/// A polygon as a ring of corners, for cutting pieces off without moving the rest. A corner within `snap_` of
/// a cut lies on it: so no two corners get so near each other that rounding turns the side between them.
class Ring {
 public:
  explicit Ring(const PatchPolygon& polygon) noexcept : count_(static_cast<int>(polygon.size())) {
    for (int i = 0; i < count_; ++i)
      corners_[Index(i)] = {polygon[Index(i)], i + 1 == count_ ? 0 : i + 1, i == 0 ? count_ - 1 : i - 1};
    for (const Vec2& x : polygon) snap_ = std::max(snap_, tolerances::kCoplanar * x.lpNorm<1>());
  }

  /// The corner farthest along `d`, looked for from the last one on, counter-clockwise.
  void advance(const Vec2& d) noexcept {
    for (int turns = 0; turns < count_; ++turns) {
      const int next = corners_[Index(top_)].next;
      if (d.dot(at(next)) < d.dot(at(top_))) return;
      top_ = next;
    }
  }
  void start(const Vec2& d) noexcept {
    for (int i = 1; i < count_; ++i)
      if (d.dot(at(i)) > d.dot(at(top_))) top_ = i;
  }

  /// Cuts off what is beyond normal . x = offset (`normal` unit); false when nothing is left.
  bool cut(const Vec2& normal, double offset) noexcept {
    const auto height = [&](int i) { return normal.dot(at(i)) - offset; };
    if (height(top_) <= snap_) return true;
    int ahead = corners_[Index(top_)].next;
    while (height(ahead) > snap_) {
      if (ahead == top_) return false;
      ahead = corners_[Index(ahead)].next;
    }
    int behind = corners_[Index(top_)].previous;
    while (height(behind) > snap_) behind = corners_[Index(behind)].previous;
    const int first = crossing(behind, corners_[Index(behind)].next, height);
    const int second = crossing(ahead, corners_[Index(ahead)].previous, height);
    if (first != behind) link(behind, first);
    link(first, second);
    if (second != ahead) link(second, ahead);
    top_ = second;
    return true;
  }

  void copy_to(PatchPolygon& polygon) const noexcept {
    polygon.clear();
    int i = top_;
    do {
      polygon.push_back(corners_[Index(i)].x);
      i = corners_[Index(i)].next;
    } while (i != top_ && !polygon.full());
  }

 private:
  using Index = std::size_t;
  struct Corner {
    Vec2 x;
    int next, previous;
  };
  const Vec2& at(int i) const noexcept { return corners_[Index(i)].x; }
  void link(int a, int b) noexcept {
    corners_[Index(a)].next = b;
    corners_[Index(b)].previous = a;
  }
  template <class Height>
  int crossing(int inside, int outside, const Height& height) noexcept {
    const double low = height(inside);
    if (low >= -snap_) return inside;
    corners_[Index(count_)].x = at(inside) + (at(outside) - at(inside)) * (low / (low - height(outside)));
    return count_++;
  }

  std::array<Corner, PatchPolygon::capacity() + 2 * PatchPolygon::capacity()> corners_;
  int count_;
  int top_ = 0;
  double snap_ = 0.0;  // [m]
};

}  // namespace

void clip_polygon(PatchPolygon& polygon, const Vec2& normal, double offset) noexcept {
  bool cut = false;
  for (const Vec2& x : polygon) cut |= normal.dot(x) > offset;
  if (!cut) return;
  const PatchPolygon whole = polygon;
  polygon.clear();
  const std::size_t n = whole.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2& a = whole[i];
    const Vec2& b = whole[i + 1 == n ? 0 : i + 1];
    const double ha = normal.dot(a) - offset;
    const double hb = normal.dot(b) - offset;
    if (ha <= 0.0) polygon.push_back(a);
    if ((ha < 0.0 && hb > 0.0) || (ha > 0.0 && hb < 0.0)) polygon.push_back(a + (b - a) * (ha / (ha - hb)));
  }
}

void clip_polygon(PatchPolygon& polygon, const PatchPolygon& window) noexcept {
  if (polygon.empty()) return;
  Ring ring(polygon);
  const std::size_t n = window.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2& a = window[i];
    const Vec2 side = window[i + 1 == n ? 0 : i + 1] - a;
    const Vec2 outward = Vec2(side.y(), -side.x()).normalized();
    if (i == 0) ring.start(outward);
    ring.advance(outward);
    if (!ring.cut(outward, outward.dot(a))) return polygon.clear();
  }
  ring.copy_to(polygon);
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
