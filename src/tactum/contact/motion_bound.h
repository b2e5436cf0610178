#pragma once
/// How far the points of a body can have moved between two poses.

#include <cmath>

#include "tactum/math/pose.h"

namespace tactum::inline v0_1 {

/// How far any point within `radius` of the origin has moved: the origin's displacement plus the chord of the
/// turn, whose matrix difference has Frobenius norm sqrt(2) chord / radius.
inline double displacement(const Pose& from, const Pose& to, double radius) {
  return (to.p - from.p).norm() + radius * (to.R - from.R).norm() / std::sqrt(2.0);
}

}  // namespace tactum::inline v0_1
