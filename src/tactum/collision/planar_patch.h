#pragma once
/// Flat figures in a plane: convex polygons of bounded size, clipping, and their moments.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tactum/base/static_vector.h"
#include "tactum/math/types.h"

namespace tactum::inline v0_1 {

/// The most corners that are taken from one face; of a face with more, every k-th: an inner polygon, so that
/// no contact is invented.
inline constexpr int kPatchCorners = 64;

/// Counter-clockwise. Room for one face clipped by another, and by the gap and the lean of both.
using PatchPolygon = StaticVector<Vec2, 2 * kPatchCorners + 4>;

/// Reduces convex `polygon` to the part where normal . x <= offset [Sutherland and Hodgman 1974].
void clip_polygon(PatchPolygon& polygon, const Vec2& normal, double offset) noexcept;

/// `polygon` clipped by every side of `window`, both convex and counter-clockwise. Few corners are cut side
/// by side. Of many, the outermost corner of the polygon moves around with the side of the window, so all
/// sides together cost as much as going around both once.
void clip_polygon(PatchPolygon& polygon, const PatchPolygon& window) noexcept;

/// A rectangle along the axes.
struct PatchBox {
  Vec2 low = Vec2::Zero(), high = Vec2::Zero();
};

/// `polygon` clipped by a box, both sides across an axis in one pass; `size`: of the pieces [m]. A polygon
/// that has more than kPatchCorners + 2 corners between the first two sides is emptied: it is no convex
/// face's outline.
void clip_polygon(PatchPolygon& polygon, const PatchBox& box, double size) noexcept;

/// Twice the signed area: positive when counter-clockwise.
double twice_area(const PatchPolygon& polygon) noexcept;

/// Area, centroid and second moments of a polygon. The second moments are not divided by 4 area^2: spread_of
/// divides them, so that the latency of the division overlaps that of its square roots.
struct PatchMoments {
  double area = 0.0;                    ///< [m^2]
  Vec2 centroid = Vec2::Zero();         ///< [m]
  double xx = 0.0, xy = 0.0, yy = 0.0;  ///< second moments about the centroid, times 4 area^2 [m^6]
};

PatchMoments moments_of(const PatchPolygon& polygon) noexcept;
/// Of two figures that do not overlap, as one.
PatchMoments together(const PatchMoments& a, const PatchMoments& b) noexcept;

/// Two arms u, v with u u' + v v' = 2 [xx xy; xy yy] of the patch: points at centroid +- u and +- v, a
/// quarter of the weight each, have the polygon's moments.
struct PatchSpread {
  Vec2 u = Vec2::Zero(), v = Vec2::Zero();  ///< [m]
};

/// The symmetric root of the matrix, along unit `axis` and across it. Unlike its own axes it is continuous,
/// also where the patch is as long as it is wide.
inline PatchSpread spread_of(const PatchMoments& m, const Vec2& axis) noexcept {
  const double root = std::sqrt(std::max(0.0, m.xx * m.yy - m.xy * m.xy));
  const double trace = m.xx + m.yy + 2.0 * root;
  if (!(trace > 0.0)) return {};
  const double scale =
      std::sqrt(trace) * (0.5 * std::numbers::sqrt2 / (trace * m.area));  // both at the same time
  const double xx = m.xx + root;
  const double yy = m.yy + root;
  const double c = axis.x();
  const double s = axis.y();
  return {{(xx * c + m.xy * s) * scale, (m.xy * c + yy * s) * scale},
          {(m.xy * c - xx * s) * scale, (yy * c - m.xy * s) * scale}};
}

/// A part of a segment x0 + (x1 - x0) s.
struct PatchInterval {
  double low = 0.0, high = 1.0;  ///< of s
  bool empty() const noexcept { return low > high; }
  /// Keeps where at0 + (at1 - at0) s <= limit.
  void keep_below(double at0, double at1, double limit) noexcept {
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
};

}  // namespace tactum::inline v0_1
