#pragma once
/// The motion of a body B as another one, A, sees it: between two poses a point of B, the pivot, moves on a
/// line, while B turns about it at a constant rate. Of a body on a hinge the pivot is a point of the axis.

#include "tactum/math/screw.h"

namespace tactum::inline v0_1 {

struct RelativeMotion {
  Pose X_AB;                  ///< at the start, s = 0 [m]
  Twist by;                   ///< the pivot's displacement and the turn until the end, s = 1 [m, rad]
  Vec3 pivot = Vec3::Zero();  ///< where it is at the start [m]; all in A's axes

  /// The pose at the fraction `s` of the motion.
  Pose at(double s) const {
    const Mat3 turn = exp_rotation(by.w * s);
    return {turn * X_AB.R, pivot + by.v * s + rotated(turn, X_AB.p - pivot)};
  }
  /// The displacement that a point has at first, times one: it goes on on an arc [m].
  Vec3 displacement(const Vec3& p_A) const { return velocity_at(by, p_A - pivot); }
  /// A bound of the second derivative by `s` of the height along unit `n` of a point within `radius` of p_A:
  /// the point turns on a circle, of which the height sees the part of n that is square to the axis [m].
  double curving(const Vec3& n, const Vec3& p_A, double radius) const {
    return by.w.norm() * n.cross(by.w).norm() * ((p_A - pivot).norm() + radius);
  }
};

/// The motion that takes B from one pose to another by the shortest turn about a pivot.
inline RelativeMotion motion_between(const Pose& start, const Pose& end, const Vec3& pivot_A) {
  const Mat3 turn = end.R * start.R.transpose();
  return {start, {end.p + rotated(turn, pivot_A - start.p) - pivot_A, log_rotation(turn)}, pivot_A};
}

}  // namespace tactum::inline v0_1
