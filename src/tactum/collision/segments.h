#pragma once
/// Where two lines, and two segments, come nearest.

#include <algorithm>

#include "tactum/base/tolerances.h"
#include "tactum/math/types.h"

namespace tactum {

/// Where two lines come nearest: p0 + s u and q0 + t w, u and w unit. Solved by cross products, whose error
/// grows with 1/sine where that of the normal equations grows with its square. False when the sine is below
/// `least_sine`.
inline bool nearest_on_lines(const Vec3& p0, const Vec3& u, const Vec3& q0, const Vec3& w, double least_sine,
                             double& s, double& t) noexcept {
  const Vec3 c = u.cross(w);
  const double sine_sq = c.squaredNorm();
  if (sine_sq < least_sine * least_sine) return false;
  const Vec3 r = q0 - p0;
  s = r.cross(w).dot(c) / sine_sq;
  t = w.dot(u * s - r);  // square to w, even where s has lost digits
  return true;
}

struct SegmentPair {
  double s = 0.0, t = 0.0;  ///< lengths along the two [m]
};

/// Closest points of two segments p0 + s u, s in [0, lp], and q0 + t w, t in [0, lq].
inline SegmentPair nearest_on_segments(const Vec3& p0, const Vec3& u, double lp, const Vec3& q0,
                                       const Vec3& w, double lq) noexcept {
  SegmentPair x;
  if (!nearest_on_lines(p0, u, q0, w, tolerances::kSameArc, x.s,
                        x.t)) {  // parallel: the middle of what they share
    const double a = u.dot(q0 - p0);
    const double b = u.dot(q0 + w * lq - p0);
    x.s = 0.5 * (std::clamp(std::min(a, b), 0.0, lp) + std::clamp(std::max(a, b), 0.0, lp));
    x.t = std::clamp(w.dot(p0 + u * x.s - q0), 0.0, lq);
    return x;
  }
  if (x.s < 0.0 || x.s > lp) {
    x.s = std::clamp(x.s, 0.0, lp);
    x.t = w.dot(p0 + u * x.s - q0);
  }
  if (x.t < 0.0 || x.t > lq) {
    x.t = std::clamp(x.t, 0.0, lq);
    x.s = std::clamp(u.dot(q0 + w * x.t - p0), 0.0, lp);
  }
  return x;
}

}  // namespace tactum
