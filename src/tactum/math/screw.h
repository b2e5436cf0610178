#pragma once
/// Rotations and rigid motions as exponentials: moving a pose by a twist, and the twist between two poses.
/// Translation and rotation are kept apart (the origin moves on a line while the body turns about it), which
/// is what "velocities from the difference of two transforms" means in [Gregory 2000, 6.1].

#include "tactum/base/tolerances.h"
#include "tactum/math/spatial.h"

namespace tactum::inline v0_1 {

/// The rotation by |w| radians about w.
inline Mat3 exp_rotation(const Vec3& w) {
  const double angle_sq = w.squaredNorm();
  double s = 0.0;  // sin(a)/a
  double c = 0.0;  // (1-cos(a))/a^2
  if (angle_sq < tolerances::kSmallAngleSquared) {
    s = 1.0 - angle_sq * (1.0 / 6.0) * (1.0 - angle_sq * (1.0 / 20.0) * (1.0 - angle_sq * (1.0 / 42.0)));
    c = 0.5 - angle_sq * (1.0 / 24.0) * (1.0 - angle_sq * (1.0 / 30.0) * (1.0 - angle_sq * (1.0 / 56.0)));
  } else {
    const double angle = std::sqrt(angle_sq);
    s = std::sin(angle) / angle;
    c = (1.0 - std::cos(angle)) / angle_sq;
  }
  // 1 + s W + c W W, W = skew(w), each entry by itself: no product of matrices is needed.
  const Vec3 v = s * w, u = c * w;
  Mat3 R;
  R(0, 0) = 1.0 - (u.z() * w.z() + u.y() * w.y());
  R(1, 0) = u.x() * w.y() + v.z();
  R(2, 0) = u.x() * w.z() - v.y();
  R(0, 1) = u.y() * w.x() - v.z();
  R(1, 1) = 1.0 - (u.z() * w.z() + u.x() * w.x());
  R(2, 1) = u.y() * w.z() + v.x();
  R(0, 2) = u.z() * w.x() + v.y();
  R(1, 2) = u.z() * w.y() - v.x();
  R(2, 2) = 1.0 - (u.y() * w.y() + u.x() * w.x());
  return R;
}

/// The rotation vector of R, of length in [0, pi].
inline Vec3 log_rotation(const Mat3& R) {
  Quat q(R);
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  const double sine_sq = q.vec().squaredNorm();
  if (sine_sq < tolerances::kSmallHalfAngleSineSquared) {
    const double arc =
        1.0 + sine_sq * (1.0 / 6.0 +
                         sine_sq * (3.0 / 40.0 + sine_sq * (15.0 / 336.0 + sine_sq * (105.0 / 3456.0))));
    return 2.0 * arc * q.vec();
  }
  const double sine = std::sqrt(sine_sq);
  return 2.0 * std::atan2(sine, q.w()) / sine * q.vec();
}

/// `X_WB` after moving with V_WB for `dt` seconds.
inline Pose advanced(const Pose& X_WB, const Twist& V_WB, double dt) {
  return {exp_rotation(V_WB.w * dt) * X_WB.R, X_WB.p + V_WB.v * dt};
}

/// The constant twist that takes X_WB to X_WC in `dt` seconds: advanced(X_WB, result, dt) == X_WC.
inline Twist twist_between(const Pose& X_WB, const Pose& X_WC, double dt) {
  return {(X_WC.p - X_WB.p) / dt, log_rotation(X_WC.R * X_WB.R.transpose()) / dt};
}

/// The angle of R about a unit axis, in (-2 pi, 2 pi): that of the turn about it which leaves the shortest
/// turn to be made before it.
inline double turn_about(const Mat3& R, const Vec3& axis) {
  const Quat q(R);
  return 2.0 * std::atan2(q.vec().dot(axis), q.w());
}

/// The turn of R before its turn about a unit axis; it is square to the axis.
inline Vec3 turn_aside(const Mat3& R, const Vec3& axis) {
  return log_rotation(exp_rotation(axis * -turn_about(R, axis)) * R);
}

/// A turn that is followed over half a turn and full turns.
struct FollowedTurn {
  Vec3 turn = Vec3::Zero();  ///< [rad]
  Vec3 axis = Vec3::Zero();  ///< its direction when it was last below kLong; unit, or zero at first [-]

  static constexpr double kShort = 2.0, kLong = 2.8;  // [rad]
};

/// The turn of R, near that of a moment before. Below 2 rad it is the rotation vector. That one has no way
/// past half a turn, and beyond it a turn aside would grow instead of being undone; so from 2.8 rad on the
/// turn is that about the axis, with its full turns, and beside it the shortest turn that is made before it.
/// Between, the one passes into the other.
inline Vec3 followed_turn(const Mat3& R, const FollowedTurn& before) {
  const Vec3 shortest = log_rotation(R);
  const double angle = before.turn.norm();
  if (angle <= FollowedTurn::kShort) return shortest;
  const Vec3& axis = before.axis;
  const double about = turn_about(R, axis);
  const Vec3 aside = turn_aside(R, axis);
  const double turns = std::round((before.turn.dot(axis) - about) / (2.0 * kPi));
  const Vec3 followed = aside + axis * (about + 2.0 * kPi * turns);
  const double share =
      std::min(1.0, (angle - FollowedTurn::kShort) / (FollowedTurn::kLong - FollowedTurn::kShort));
  return share * followed + (1.0 - share) * shortest;
}

/// Follows the turn of R.
inline void follow(const Mat3& R, FollowedTurn& followed) {
  followed.turn = followed_turn(R, followed);
  const double angle = followed.turn.norm();
  if (angle > 0.0 && angle <= FollowedTurn::kLong) followed.axis = followed.turn / angle;
}

/// The pose at the fraction `s` in [0, 1] of the motion from X_WB (0) to X_WC (1).
inline Pose interpolated(const Pose& X_WB, const Pose& X_WC, double s) {
  return advanced(X_WB, twist_between(X_WB, X_WC, 1.0), s);
}

}  // namespace tactum::inline v0_1
