#pragma once
/// Flat figures in the contact plane: convex polygons of bounded size, clipping, and their moments.

#include <algorithm>
#include <cmath>

#include "tactum/base/static_vector.h"
#include "tactum/math/types.h"

namespace tactum {

/// Corners taken of one face; of a face with more, every k-th: an inner polygon, so that no contact is
/// invented.
inline constexpr int kPatchCorners = 64;

/// Counter-clockwise. Room for one face clipped by another, and by the gap and the lean of both.
using PatchPolygon = StaticVector<Vec2, 2 * kPatchCorners + 4>;

/// What is left of convex `polygon` where normal . x <= offset [Sutherland and Hodgman 1974].
void clip_polygon(PatchPolygon& polygon, const Vec2& normal, double offset) noexcept;

/// `polygon` clipped by every side of `window`, both convex and counter-clockwise. Few corners are cut side
/// by side. Of many, the outermost corner of the polygon moves around with the side of the window, so all
/// sides together cost as much as going around both once.
void clip_polygon(PatchPolygon& polygon, const PatchPolygon& window) noexcept;

/// Twice the signed area: positive when counter-clockwise.
double twice_area(const PatchPolygon& polygon) noexcept;

struct PatchMoments {
  double area = 0.0;                    ///< [m^2]
  Vec2 centroid = Vec2::Zero();         ///< [m]
  double xx = 0.0, xy = 0.0, yy = 0.0;  ///< second moments about the centroid over the area [m^2]
};

PatchMoments moments_of(const PatchPolygon& polygon) noexcept;
/// Of two figures that do not overlap, as one.
PatchMoments together(const PatchMoments& a, const PatchMoments& b) noexcept;

/// Two arms u, v with u u' + v v' = 2 [xx xy; xy yy]: points at centroid +- u and +- v, a quarter of the
/// weight each, have the polygon's moments. The symmetric root of the matrix: unlike its axes it is
/// continuous, also where the patch is as long as it is wide.
struct PatchSpread {
  Vec2 u = Vec2::Zero(), v = Vec2::Zero();  ///< [m]
};

inline PatchSpread spread_of(const PatchMoments& m) noexcept {
  const double root = std::sqrt(std::max(0.0, m.xx * m.yy - m.xy * m.xy));
  const double trace = m.xx + m.yy + 2.0 * root;
  if (!(trace > 0.0)) return {};
  const double scale = std::sqrt(2.0 * trace) * (1.0 / trace);  // root and quotient at the same time
  return {{(m.xx + root) * scale, m.xy * scale}, {m.xy * scale, (m.yy + root) * scale}};
}

/// A straight piece x0 + (x1 - x0) s of the plane.
struct PatchInterval {
  double low = 0.0, high = 1.0;  ///< of s
  bool empty() const noexcept { return low > high; }
  /// Keeps where at0 + (at1 - at0) s <= limit.
  void keep_below(double at0, double at1, double limit) noexcept;
};

}  // namespace tactum
