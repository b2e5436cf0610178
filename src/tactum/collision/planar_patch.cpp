#include "tactum/collision/planar_patch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "tactum/base/tolerances.h"

namespace tactum {
namespace {

double cross(const Vec2& a, const Vec2& b) noexcept { return a.x() * b.y() - a.y() * b.x(); }

/// A side of the window as a cut: heights over it are in metres times the side's length, `scale` to within a
/// factor of 1.5, so that no root is drawn.
struct Cut {
  Vec2 outward;
  double offset;
  double scale = 1.0;

  Cut(const Vec2& normal, double reach) noexcept : outward(normal), offset(reach) {}
  Cut(const Vec2& from, const Vec2& to) noexcept
      : outward(to.y() - from.y(), from.x() - to.x()),
        offset(outward.x() * from.x() + outward.y() * from.y()),
        scale(std::abs(outward.x()) + std::abs(outward.y())) {}
  double height(const Vec2& x) const noexcept { return outward.x() * x.x() + outward.y() * x.y() - offset; }
};

/// A corner within this share of the polygon's extent of a cut lies on it: so no two corners get so near each
/// other that rounding turns the side between them.
constexpr double kSnap = tolerances::kCoplanar;

double extent(double most, const Vec2& x) noexcept {
  return std::max(most, std::abs(x.x()) + std::abs(x.y()));
}

/// A polygon as a ring of corners, for cutting pieces off without moving the rest.
class Ring {
 public:
  /// `first` is the first side that will cut: the farthest corner for it is found on the way.
  Ring(const PatchPolygon& polygon, const Cut& first) noexcept : count_(static_cast<int>(polygon.size())) {
    double most = 0.0;
    double top_height = -std::numeric_limits<double>::infinity();
    for (int i = 0; i < count_; ++i) {
      const Vec2& x = polygon[Index(i)];
      Corner& corner = corners_[Index(i)];
      corner.x = x;
      corner.next = i + 1;
      corner.previous = i - 1;
      most = extent(most, x);
      if (const double height = first.height(x); height > top_height) {
        top_height = height;
        top_ = i;
      }
    }
    link(count_ - 1, 0);
    snap_ = kSnap * most;
  }

  /// Cuts off what is beyond; false when nothing is left. The farthest corner is looked for from the last one
  /// on, counter-clockwise, and every height is taken once.
  bool cut(const Cut& side) noexcept {
    const double snap = snap_ * side.scale;
    double top_height = side.height(at(top_));
    int ahead = next(top_);
    double ahead_height = side.height(at(ahead));
    for (int turns = 0; turns < count_ && ahead_height >= top_height; ++turns) {
      top_ = ahead;
      top_height = ahead_height;
      ahead = next(top_);
      ahead_height = side.height(at(ahead));
    }
    if (top_height <= snap) return true;
    int outside = top_;
    double height = top_height;
    while (ahead_height > snap) {
      if (ahead == top_) return false;
      outside = ahead;
      height = ahead_height;
      ahead = next(ahead);
      ahead_height = side.height(at(ahead));
    }
    const int second = crossing(ahead, ahead_height, outside, height, snap);
    outside = top_;
    height = top_height;
    int behind = previous(top_);
    double behind_height = side.height(at(behind));
    while (behind_height > snap) {
      outside = behind;
      height = behind_height;
      behind = previous(behind);
      behind_height = side.height(at(behind));
    }
    const int first = crossing(behind, behind_height, outside, height, snap);
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
  int next(int i) const noexcept { return corners_[Index(i)].next; }
  int previous(int i) const noexcept { return corners_[Index(i)].previous; }
  void link(int a, int b) noexcept {
    corners_[Index(a)].next = b;
    corners_[Index(b)].previous = a;
  }
  int crossing(int inside, double low, int outside, double high, double snap) noexcept {
    if (low >= -snap) return inside;
    corners_[Index(count_)].x = at(inside) + (at(outside) - at(inside)) * (low / (low - high));
    return count_++;
  }

  std::array<Corner, PatchPolygon::capacity() + 2 * PatchPolygon::capacity()> corners_;
  int count_;
  int top_ = 0;
  double snap_ = 0.0;  // [m]
};

/// Corners of what a cut leaves of a convex polygon of `n` [Sutherland and Hodgman 1974], in one pass. Room
/// for n + 2 corners is the caller's.
inline std::size_t cut_off(const Vec2* from, std::size_t n, const Cut& cut, double snap, Vec2* to) noexcept {
  // Numbers of its own, which stay in registers while corners are stored.
  const double out_x = cut.outward.x();
  const double out_y = cut.outward.y();
  const double offset = cut.offset;
  Vec2* end = to;
  double last_x = from[n - 1].x();
  double last_y = from[n - 1].y();
  double last_height = cut.height(from[n - 1]);
  for (std::size_t i = 0; i < n; ++i) {
    const double x = from[i].x();
    const double y = from[i].y();
    const double height = out_x * x + out_y * y - offset;
    const bool inside = height <= snap;
    if (inside ? last_height > snap && height < -snap : last_height < -snap) {
      const double s = last_height / (last_height - height);
      *end++ = {last_x + (x - last_x) * s, last_y + (y - last_y) * s};
    }
    if (inside) *end++ = {x, y};
    last_x = x;
    last_y = y;
    last_height = height;
  }
  return static_cast<std::size_t>(end - to);
}

Cut side_of(const PatchPolygon& window, std::size_t i) noexcept {
  const Vec2* corners = window.begin();
  return {corners[i], corners[i + 1 == window.size() ? 0 : i + 1]};
}

}  // namespace

void clip_polygon(PatchPolygon& polygon, const Vec2& normal, double offset) noexcept {
  if (polygon.empty()) return;
  std::array<Vec2, PatchPolygon::capacity() + 2> kept;
  const std::size_t n = cut_off(polygon.begin(), polygon.size(), {normal, offset}, 0.0, kept.data());
  polygon.assign(kept.data(), n);
}

void clip_polygon(PatchPolygon& polygon, const PatchPolygon& window) noexcept {
  constexpr std::size_t kFew = 6;  // corners of both up to which going around costs more than it saves
  if (polygon.empty() || window.empty()) return;
  const std::size_t sides = window.size();
  if (sides > kFew || polygon.size() > kFew) {
    Ring ring(polygon, side_of(window, 0));
    for (std::size_t i = 0; i < sides; ++i)
      if (!ring.cut(side_of(window, i))) return polygon.clear();
    return ring.copy_to(polygon);
  }
  double most = 0.0;
  for (const Vec2& x : polygon) most = extent(most, x);
  const double snap = kSnap * most;
  // Every cut of a convex polygon adds one corner, or two by rounding.
  std::array<std::array<Vec2, 3 * kFew + 2>, 2> rows;
  const Vec2* from = polygon.begin();
  std::size_t n = polygon.size();
  const Vec2* tail = window.end() - 1;
  for (const Vec2* head = window.begin(); head != window.end() && n > 0; tail = head++) {
    const Cut cut(*tail, *head);
    Vec2* to = rows[from == rows[0].data() ? 1 : 0].data();
    n = cut_off(from, n, cut, snap * cut.scale, to);
    from = to;
  }
  // One number at a time: wider loads would wait for the stores of the last cut.
  polygon.clear();
  for (std::size_t i = 0; i < n; ++i) polygon.push_back({from[i].x(), from[i].y()});
}

double twice_area(const PatchPolygon& polygon) noexcept {
  double sum = 0.0;
  for (std::size_t i = 2; i < polygon.size(); ++i)
    sum += cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]);
  return sum;
}

PatchMoments moments_of(const PatchPolygon& polygon) noexcept {
  PatchMoments m;
  const std::size_t n = polygon.size();
  if (n < 3) return m;
  // Sums over the triangles of a fan at corner 0, about corner 0.
  const Vec2* corners = polygon.begin();
  const double ox = corners[0].x();
  const double oy = corners[0].y();
  double twice = 0.0;
  double fx = 0.0;
  double fy = 0.0;
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  double ax = corners[1].x() - ox;
  double ay = corners[1].y() - oy;
  for (std::size_t i = 2; i < n; ++i) {
    const double bx = corners[i].x() - ox;
    const double by = corners[i].y() - oy;
    const double ax_by = ax * by;
    const double ay_bx = ay * bx;
    const double weight = ax_by - ay_bx;
    const double sx = ax + bx;
    const double sy = ay + by;
    twice += weight;
    fx += weight * sx;
    fy += weight * sy;
    xx += weight * (sx * sx - ax * bx);
    xy += weight * (2.0 * sx * sy - ax_by - ay_bx);
    yy += weight * (sy * sy - ay * by);
    ax = bx;
    ay = by;
  }
  m.area = 0.5 * twice;
  if (!(m.area > 0.0)) return m;
  const double share = 1.0 / twice;
  const double third = share * (1.0 / 3.0);
  const double sixth = share * (1.0 / 6.0);
  const Vec2 c(fx * third, fy * third);
  m.centroid = {ox + c.x(), oy + c.y()};
  m.xx = std::max(0.0, xx * sixth - c.x() * c.x());
  m.xy = xy * 0.5 * sixth - c.x() * c.y();
  m.yy = std::max(0.0, yy * sixth - c.y() * c.y());
  return m;
}

PatchMoments together(const PatchMoments& a, const PatchMoments& b) noexcept {
  PatchMoments m;
  m.area = a.area + b.area;
  if (!(m.area > 0.0)) return m;
  const double of_a = a.area / m.area;
  const double of_b = b.area / m.area;
  m.centroid = of_a * a.centroid + of_b * b.centroid;
  // Steiner: the distance of the two centroids adds what it weighs.
  const Vec2 apart = b.centroid - a.centroid;
  const double both = of_a * of_b;
  m.xx = of_a * a.xx + of_b * b.xx + both * apart.x() * apart.x();
  m.xy = of_a * a.xy + of_b * b.xy + both * apart.x() * apart.y();
  m.yy = of_a * a.yy + of_b * b.yy + both * apart.y() * apart.y();
  return m;
}

PatchSpread spread_of(const PatchMoments& m) noexcept {
  const double root = std::sqrt(std::max(0.0, m.xx * m.yy - m.xy * m.xy));
  const double trace = m.xx + m.yy + 2.0 * root;
  if (!(trace > 0.0)) return {};
  const double scale = std::sqrt(2.0 / trace);
  return {{(m.xx + root) * scale, m.xy * scale}, {m.xy * scale, (m.yy + root) * scale}};
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
