#pragma once
/// The nearest points of two lines, and of two segments.

#include <algorithm>

#include "tactum/base/tolerances.h"
#include "tactum/math/types.h"

namespace tactum::inline v0_1 {

/// The nearest points of two lines: p0 + s u and q0 + t w, u and w unit, r = q0 - p0, c = u x w. Solved by
/// cross products, whose error grows with 1/sine where that of the normal equations grows with its square.
/// False when the sine is below `least_sine`.
inline bool nearest_on_lines(const Vec3& u, const Vec3& w, const Vec3& r, const Vec3& c, double least_sine,
                             double& s, double& t) noexcept {
  const double sine_sq = c.squaredNorm();
  if (sine_sq < least_sine * least_sine) return false;
  s = r.cross(w).dot(c) / sine_sq;
  t = w.dot(u * s - r);  // square to w, even where s has lost digits
  return true;
}

struct SegmentPair {
  double s = 0.0, t = 0.0;  ///< lengths along the two [m]
};

/// Closest points of two segments p0 + s u, s in [0, lp], and q0 + t w, t in [0, lq]; r and c as above.
inline SegmentPair nearest_on_segments(const Vec3& u, double lp, const Vec3& w, double lq, const Vec3& r,
                                       const Vec3& c) noexcept {
  SegmentPair x;
  if (!nearest_on_lines(u, w, r, c, tolerances::kSameArc, x.s, x.t)) {
    // Parallel: the middle of the part they have in common.
    const double a = u.dot(r);
    const double b = u.dot(r + w * lq);
    x.s = 0.5 * (std::clamp(std::min(a, b), 0.0, lp) + std::clamp(std::max(a, b), 0.0, lp));
    x.t = std::clamp(w.dot(u * x.s - r), 0.0, lq);
    return x;
  }
  if (x.s < 0.0 || x.s > lp) {
    x.s = std::clamp(x.s, 0.0, lp);
    x.t = w.dot(u * x.s - r);
  }
  if (x.t < 0.0 || x.t > lq) {
    x.t = std::clamp(x.t, 0.0, lq);
    x.s = std::clamp(u.dot(r + w * x.t), 0.0, lp);
  }
  return x;
}

}  // namespace tactum::inline v0_1
