#include "tactum/collision/planar_patch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "tactum/base/tolerances.h"

namespace tactum {
namespace {

double cross(const Vec2& a, const Vec2& b) noexcept { return a.x() * b.y() - a.y() * b.x(); }

/// A corner within this of a cut lies on it: so no two corners get so near each other that rounding turns the
/// side between them [m].
double snap_of(const PatchPolygon& polygon) noexcept {
  double most = 0.0;
  for (const Vec2& x : polygon) most = std::max(most, std::abs(x.x()) + std::abs(x.y()));
  return tolerances::kCoplanar * most;
}

/// A side of the window as a cut: heights over it are in metres times the side's length, `scale` to within a
/// factor of 1.5, so that no root is drawn.
struct Cut {
  Vec2 outward;
  double offset;
  double scale;

  Cut(const Vec2& from, const Vec2& to) noexcept
      : outward(to.y() - from.y(), from.x() - to.x()),
        offset(outward.x() * from.x() + outward.y() * from.y()),
        scale(std::abs(outward.x()) + std::abs(outward.y())) {}
  double height(const Vec2& x) const noexcept {
    return outward.x() * x.x() + outward.y() * x.y() - offset;
  }
};

/// A polygon as a ring of corners, for cutting pieces off without moving the rest.
class Ring {
 public:
  Ring(const PatchPolygon& polygon, double snap) noexcept
      : count_(static_cast<int>(polygon.size())), snap_(snap) {
    for (int i = 0; i < count_; ++i)
      corners_[Index(i)] = {polygon[Index(i)], i + 1 == count_ ? 0 : i + 1, i == 0 ? count_ - 1 : i - 1};
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

  /// Cuts off what is beyond; false when nothing is left.
  bool cut(const Cut& side) noexcept {
    const double snap = snap_ * side.scale;
    const auto height = [&](int i) { return side.height(at(i)); };
    if (height(top_) <= snap) return true;
    int ahead = corners_[Index(top_)].next;
    while (height(ahead) > snap) {
      if (ahead == top_) return false;
      ahead = corners_[Index(ahead)].next;
    }
    int behind = corners_[Index(top_)].previous;
    while (height(behind) > snap) behind = corners_[Index(behind)].previous;
    const int first = crossing(behind, corners_[Index(behind)].next, height, snap);
    const int second = crossing(ahead, corners_[Index(ahead)].previous, height, snap);
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
  int crossing(int inside, int outside, const Height& height, double snap) noexcept {
    const double low = height(inside);
    if (low >= -snap) return inside;
    corners_[Index(count_)].x = at(inside) + (at(outside) - at(inside)) * (low / (low - height(outside)));
    return count_++;
  }

  std::array<Corner, PatchPolygon::capacity() + 2 * PatchPolygon::capacity()> corners_;
  int count_;
  int top_ = 0;
  double snap_;  // [m]
};

/// What is below the line of `height`, by the heights of all corners [Sutherland and Hodgman 1974]. A polygon
/// with no corner more than `snap` above it stays as it is.
template <class Height>
void cut_polygon(PatchPolygon& polygon, const Height& height, double snap) noexcept {
  std::array<double, PatchPolygon::capacity()> heights;
  const std::size_t n = polygon.size();
  bool cut = false;
  for (std::size_t i = 0; i < n; ++i) {
    heights[i] = height(polygon[i]);
    cut |= heights[i] > snap;
  }
  if (!cut) return;
  std::array<Vec2, PatchPolygon::capacity()> corners;
  std::copy(polygon.begin(), polygon.end(), corners.begin());
  polygon.clear();
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t next = i + 1 == n ? 0 : i + 1;
    const double h = heights[i];
    const double h_next = heights[next];
    if (h <= snap) polygon.push_back(corners[i]);
    if ((h < -snap && h_next > snap) || (h > snap && h_next < -snap))
      polygon.push_back(corners[i] + (corners[next] - corners[i]) * (h / (h - h_next)));
  }
}

}  // namespace

void clip_polygon(PatchPolygon& polygon, const Vec2& normal, double offset) noexcept {
  cut_polygon(polygon, [&](const Vec2& x) { return normal.dot(x) - offset; }, 0.0);
}

void clip_polygon(PatchPolygon& polygon, const PatchPolygon& window) noexcept {
  constexpr std::size_t kFew = 36;  // pairs of corners up to which going around costs more than it saves
  if (polygon.empty()) return;
  const std::size_t n = window.size();
  const double snap = snap_of(polygon);
  const auto side = [&](std::size_t i) { return Cut(window[i], window[i + 1 == n ? 0 : i + 1]); };
  if (n * polygon.size() <= kFew) {
    for (std::size_t i = 0; i < n; ++i) {
      const Cut cut = side(i);
      cut_polygon(polygon, [&](const Vec2& x) { return cut.height(x); }, snap * cut.scale);
    }
    return;
  }
  Ring ring(polygon, snap);
  for (std::size_t i = 0; i < n; ++i) {
    const Cut cut = side(i);
    if (i == 0) ring.start(cut.outward);
    ring.advance(cut.outward);
    if (!ring.cut(cut)) return polygon.clear();
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
  const std::size_t n = polygon.size();
  if (n < 3) return m;
  // Sums over the triangles of a fan at corner 0, about corner 0.
  const Vec2 origin = polygon[0];
  double twice = 0.0;
  double fx = 0.0;
  double fy = 0.0;
  double xx = 0.0;
  double xy = 0.0;
  double yy = 0.0;
  double ax = polygon[1].x() - origin.x();
  double ay = polygon[1].y() - origin.y();
  for (std::size_t i = 2; i < n; ++i) {
    const double bx = polygon[i].x() - origin.x();
    const double by = polygon[i].y() - origin.y();
    const double weight = ax * by - ay * bx;
    const double sx = ax + bx;
    const double sy = ay + by;
    twice += weight;
    fx += weight * sx;
    fy += weight * sy;
    xx += weight * (ax * ax + bx * bx + sx * sx);
    xy += weight * (ax * ay + bx * by + sx * sy);
    yy += weight * (ay * ay + by * by + sy * sy);
    ax = bx;
    ay = by;
  }
  m.area = 0.5 * twice;
  if (!(m.area > 0.0)) return m;
  const double share = 1.0 / twice;
  const Vec2 c(fx * share / 3.0, fy * share / 3.0);
  m.centroid = origin + c;
  m.xx = std::max(0.0, xx * share / 12.0 - c.x() * c.x());
  m.xy = xy * share / 12.0 - c.x() * c.y();
  m.yy = std::max(0.0, yy * share / 12.0 - c.y() * c.y());
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
