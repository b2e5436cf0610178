#include "tactum/collision/planar_patch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "tactum/base/tolerances.h"
#include "tactum/math/two.h"

namespace tactum::inline v0_1 {
namespace {

double cross(const Vec2& a, const Vec2& b) noexcept { return a.x() * b.y() - a.y() * b.x(); }

/// A side of the window as a cut: heights over it are in metres times the side's length, `scale` to within a
/// factor of 1.5, so that no root is computed.
struct Cut {
  Vec2 outward;
  double offset;
  double scale = 1.0;

  Cut(const Vec2& normal, double distance) noexcept : outward(normal), offset(distance) {}
  Cut(const Vec2& from, const Vec2& to) noexcept
      : outward(to.y() - from.y(), from.x() - to.x()),
        offset(outward.x() * from.x() + outward.y() * from.y()),
        scale(std::abs(outward.x()) + std::abs(outward.y())) {}
  double height(const Vec2& x) const noexcept { return outward.x() * x.x() + outward.y() * x.y() - offset; }
};

/// A corner within this fraction of the polygon's extent of a cut lies on it: so no two corners get so near
/// each other that rounding reverses the side between them.
constexpr double kSnap = tolerances::kCoplanar;

double extent(double most, const Vec2& x) noexcept {
  return std::max(most, std::abs(x.x()) + std::abs(x.y()));
}

/// A polygon as a ring of corners, for cutting pieces off without moving the rest.
class Ring {
 public:
  /// `first` is the first side that will cut: the farthest corner for it is found at once.
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

  /// Cuts off the part beyond; false when nothing is left. The farthest corner is searched from the last one
  /// on, counter-clockwise, and every height is computed once.
  bool cut(const Cut& side) noexcept {
    if (!(side.scale > 0.0)) return true;  // two corners in one place: no side
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

/// The corners that a cut leaves of a convex polygon of `n` [Sutherland and Hodgman 1974], in one pass. The
/// caller provides room for n + 2 corners.
inline std::size_t cut_off(const Vec2* from, std::size_t n, const Cut& cut, double snap, Vec2* to) noexcept {
  // Local numbers, which stay in registers while corners are stored.
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

/// Where the line through `a` and `b` has this value of coordinate kAxis.
template <int kAxis>
Vec2 point_at(const Vec2& a, const Vec2& b, double value) noexcept {
  constexpr int kOther = 1 - kAxis;
  const double other = a[kOther] + (b[kOther] - a[kOther]) * ((value - a[kAxis]) / (b[kAxis] - a[kAxis]));
  return vec2(kAxis == 0 ? Two{value, other} : Two{other, value});
}

/// Writes the corners that are left of a convex polygon of `n` between `low` and `high` of coordinate kAxis;
/// returns their end. The caller provides room for n + 2; for a polygon that is not convex, for 2 n.
template <int kAxis>
Vec2* cut_between(const Vec2* from, std::size_t n, double low, double high, double snap, Vec2* to) noexcept {
  const double below = low - snap;
  const double above = high + snap;
  const Vec2* last = from + n - 1;
  int last_side = (*last)[kAxis] < below ? -1 : (*last)[kAxis] > above ? 1 : 0;
  for (const Vec2* corner = from; corner != from + n; last = corner++) {
    const double x = (*corner)[kAxis];
    const auto cross_at = [&](double value) { *to++ = point_at<kAxis>(*last, *corner, value); };
    if (x < below) {
      if (last_side < 0) continue;
      if (last_side > 0) cross_at(high);
      if ((*last)[kAxis] > low + snap) cross_at(low);
      last_side = -1;
    } else if (x > above) {
      if (last_side > 0) continue;
      if (last_side < 0) cross_at(low);
      if ((*last)[kAxis] < high - snap) cross_at(high);
      last_side = 1;
    } else {
      if (last_side < 0 && x > low + snap) cross_at(low);
      if (last_side > 0 && x < high - snap) cross_at(high);
      last_side = 0;
      *to++ = vec2(two(*corner));
    }
  }
  return to;
}

Cut side_of(const PatchPolygon& window, std::size_t i) noexcept {
  const Vec2* corners = window.begin();
  return {corners[i], corners[i + 1 == window.size() ? 0 : i + 1]};
}

/// A polygon of few corners and the up to four sides of its window. Every corner carries its heights over all
/// sides: each is computed once, and a side that no corner is beyond costs nothing more. Opposite sides of a
/// window of four are next to each other in memory and cut one after the other: the second does not wait for
/// the corners that the first makes.
class FewSides {
 public:
  static constexpr std::size_t kMost = 4;
  static constexpr std::size_t kMostCorners = 6;

  FewSides(const PatchPolygon& polygon, const PatchPolygon& window) noexcept : count_(polygon.size()) {
    const std::array<Sides, 2> sides = sides_of(window);
    Two extent = both(0.0);
    std::array<Two, 2> most = {both(0.0), both(0.0)};
    const Vec2* points = polygon.begin();
    for (std::size_t i = 0; i < count_; ++i) {
      Corner& corner = corners_[i];
      corner.x = two(points[i]);
      extent = larger(extent, magnitude(corner.x));
      for (std::size_t k = 0; k < 2; ++k) {
        corner.heights[k] = sides[k].heights(corner.x);
        most[k] = larger(most[k], corner.heights[k]);
      }
      from_[i] = &corner;
    }
    fresh_ = corners_.data() + count_;
    const double snap = kSnap * (extent[0] + extent[1]);
    for (std::size_t k = 0; k < 2; ++k) {
      snap_[k] = sides[k].scale * both(snap);
      most_[k] = most[k];
    }
  }

  FewSides(const FewSides&) = delete;  // points into itself
  FewSides& operator=(const FewSides&) = delete;

  /// Cuts off the part beyond a side [Sutherland and Hodgman 1974]; after its predecessors.
  template <std::size_t kPair, std::size_t kLane>
  void cut() noexcept {
    const double snap = snap_[kPair][kLane];
    if (!(most_[kPair][kLane] > snap) || count_ == 0) return;
    // A polygon that is not convex may cross a side more than twice. Without room for that it is given up.
    if (static_cast<std::size_t>(corners_.data() + kRoom - fresh_) < count_) {
      count_ = 0;
      return;
    }
    const Corner* last = from_[count_ - 1];
    double last_height = last->heights[kPair][kLane];
    const Corner** end = to_;
    for (std::size_t i = 0; i < count_; ++i) {
      const Corner* corner = from_[i];
      const double height = corner->heights[kPair][kLane];
      const bool inside = height <= snap;
      if (inside ? last_height > snap && height < -snap : last_height < -snap) {
        const Two s = both(last_height / (last_height - height));
        fresh_->x = last->x + (corner->x - last->x) * s;
        // The heights over sides that are yet to cut.
        for (std::size_t k = kPair + kLane; k < 2; ++k)
          fresh_->heights[k] = last->heights[k] + (corner->heights[k] - last->heights[k]) * s;
        *end++ = fresh_++;
      }
      if (inside) *end++ = corner;
      last = corner;
      last_height = height;
    }
    count_ = static_cast<std::size_t>(end - to_);
    std::swap(from_, to_);
  }

  void copy_to(PatchPolygon& polygon) const noexcept {
    polygon.fill(count_, [&](std::size_t i) { return vec2(from_[i]->x); });
  }

 private:
  struct Corner {
    Two x;
    std::array<Two, 2> heights;
  };
  /// Two sides, each as a Cut.
  struct Sides {
    Two out_x, out_y, offset, scale;
    Sides(Two from_x, Two from_y, Two to_x, Two to_y) noexcept
        : out_x(to_y - from_y),
          out_y(from_x - to_x),
          offset(out_x * from_x + out_y * from_y),
          scale(magnitude(out_x) + magnitude(out_y)) {}
    Two heights(Two x) const noexcept { return out_x * both(x[0]) + out_y * both(x[1]) - offset; }
  };
  /// Of fewer than four corners the last one again: a side without length cuts nothing off.
  static std::array<Sides, 2> sides_of(const PatchPolygon& window) noexcept {
    const Vec2* corners = window.begin();
    const std::size_t last = window.size() - 1;
    const Two c0 = two(corners[0]);
    const Two c1 = two(corners[std::min<std::size_t>(1, last)]);
    const Two c2 = two(corners[std::min<std::size_t>(2, last)]);
    const Two c3 = two(corners[last]);
    const Two odd_x = {c3[0], c1[0]};
    const Two odd_y = {c3[1], c1[1]};
    const Two even_x = {c0[0], c2[0]};
    const Two even_y = {c0[1], c2[1]};
    return {Sides(odd_x, odd_y, even_x, even_y), Sides(even_x, even_y, swapped(odd_x), swapped(odd_y))};
  }

  // Every cut of a convex polygon makes two corners, and leaves one more than there were. Room for as many
  // new ones in the last cut as there are corners then.
  static constexpr std::size_t kRoom = kMostCorners + 2 * (kMost - 1) + kMostCorners + (kMost - 1);
  std::array<Corner, kRoom> corners_;
  std::array<std::array<const Corner*, kRoom>, 2> rows_;
  const Corner** from_ = rows_[0].data();
  const Corner** to_ = rows_[1].data();
  Corner* fresh_;
  std::size_t count_;
  std::array<Two, 2> most_, snap_;
};

}  // namespace

void clip_polygon(PatchPolygon& polygon, const Vec2& normal, double offset) noexcept {
  if (polygon.empty()) return;
  std::array<Vec2, PatchPolygon::capacity() + 2> kept;
  const std::size_t n = cut_off(polygon.begin(), polygon.size(), {normal, offset}, 0.0, kept.data());
  polygon.assign(kept.data(), n);
}

void clip_polygon(PatchPolygon& polygon, const PatchPolygon& window) noexcept {
  if (polygon.empty() || window.empty()) return;
  if (window.size() <= FewSides::kMost && polygon.size() <= FewSides::kMostCorners) {
    FewSides few(polygon, window);
    few.cut<0, 0>();
    few.cut<0, 1>();
    few.cut<1, 0>();
    few.cut<1, 1>();
    return few.copy_to(polygon);
  }
  Ring ring(polygon, side_of(window, 0));
  for (std::size_t i = 0; i < window.size(); ++i)
    if (!ring.cut(side_of(window, i))) return polygon.clear();
  ring.copy_to(polygon);
}

void clip_polygon(PatchPolygon& polygon, const PatchBox& box, double size) noexcept {
  const double snap = kSnap * size;
  if (polygon.empty()) return;
  std::array<Vec2, 2 * PatchPolygon::capacity()> between;
  const Vec2* end =
      cut_between<0>(polygon.begin(), polygon.size(), box.low.x(), box.high.x(), snap, between.data());
  const std::size_t n = static_cast<std::size_t>(end - between.data());
  // A polygon that is not convex may have twice as many corners then. Without room for that it is given up;
  // for a face no side of a box makes more than two corners more.
  static_assert(2 * (kPatchCorners + 2) <= PatchPolygon::capacity());
  if (n == 0 || 2 * n > PatchPolygon::capacity()) return polygon.clear();
  polygon.overwrite(
      [&](Vec2* to) { return cut_between<1>(between.data(), n, box.low.y(), box.high.y(), snap, to); });
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
  // Sums over the triangles of a fan at corner 0, about corner 0; x and y side by side.
  const Vec2* corners = polygon.begin();
  const Two origin = two(corners[0]);
  double twice = 0.0;
  Two first = both(0.0);
  Two second = both(0.0);
  double mixed = 0.0;
  Two a = two(corners[1]) - origin;
  for (std::size_t i = 2; i < n; ++i) {
    const Two b = two(corners[i]) - origin;
    const Two crossed = a * swapped(b);  // ax by, ay bx
    const double weight = crossed[0] - crossed[1];
    const Two sum = a + b;
    twice += weight;
    first += both(weight) * sum;
    second += both(weight) * (sum * sum - a * b);
    mixed += weight * (2.0 * sum[0] * sum[1] - crossed[0] - crossed[1]);
    a = b;
  }
  m.area = 0.5 * twice;
  if (!(m.area > 0.0)) return m;
  const Two c = first * both(1.0 / 3.0);
  const Two spread = larger(second * both(twice * (1.0 / 6.0)) - c * c, both(0.0));
  m.centroid = vec2(origin + c * both(1.0 / twice));
  m.xx = spread[0];
  m.xy = mixed * (twice * (1.0 / 12.0)) - c[0] * c[1];
  m.yy = spread[1];
  return m;
}

PatchMoments together(const PatchMoments& a, const PatchMoments& b) noexcept {
  if (!(a.area > 0.0)) return b;
  if (!(b.area > 0.0)) return a;
  PatchMoments m;
  m.area = a.area + b.area;
  m.centroid = (a.area * a.centroid + b.area * b.centroid) / m.area;
  // Steiner: the distance of the two centroids adds its part.
  const Vec2 apart = b.centroid - a.centroid;
  const double of_a = m.area / a.area;
  const double of_b = m.area / b.area;
  const double steiner = 4.0 * a.area * b.area;
  m.xx = of_a * a.xx + of_b * b.xx + steiner * apart.x() * apart.x();
  m.xy = of_a * a.xy + of_b * b.xy + steiner * apart.x() * apart.y();
  m.yy = of_a * a.yy + of_b * b.yy + steiner * apart.y() * apart.y();
  return m;
}

}  // namespace tactum::inline v0_1
