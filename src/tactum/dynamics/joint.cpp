#include "tactum/dynamics/joint.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "tactum/math/screw.h"

namespace tactum::inline v0_1 {
namespace {

/// One or three unknowns, without allocation.
using SmallMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 3, 3>;

bool has_single_motion(const Joint& joint) noexcept {
  return joint.kind == JointKind::kHinge || joint.kind == JointKind::kSlider;
}

/// The turn by hinge_angle() about the hinge's axis, from the cosine and sine of half of it, as the
/// quaternion has them: without the angle.
Mat3 hinge_turn(const Joint& hinge, const Mat3& R_start, const Mat3& R) noexcept {
  const Vec3& u = hinge.axis_W;
  const Quat turn(R * R_start.transpose());
  const double w = turn.w();
  const double x = u.dot(turn.vec());
  const double square = w * w + x * x;
  if (square <= 0.0) return Mat3::Identity();  // half a turn about an axis square to the hinge's
  const double sine = 2.0 * w * x / square;
  const double less = 2.0 * x * x / square;  // 1 - cosine
  return Mat3::Identity() * (1.0 - less) + skew(u) * sine + u * u.transpose() * less;
}

}  // namespace

Resistance inertial_resistance(const Body& body, const Pose& X_WB) noexcept {
  Resistance M = Resistance::Zero();
  M.topLeftCorner<3, 3>() = body.mass_kg * Mat3::Identity();
  M.bottomRightCorner<3, 3>() = X_WB.R * body.inertia_B * X_WB.R.transpose();
  return M;
}

Vec6 single_motion(const Joint& joint, const Pose& X_WB) noexcept {
  Vec6 s;
  if (joint.kind == JointKind::kHinge)
    s << joint.axis_W.cross(X_WB.p - joint.anchor_W), joint.axis_W;
  else
    s << joint.axis_W, Vec3::Zero();
  return s;
}

JointMotions joint_motions(const Joint& joint, const Pose& X_WB) noexcept {
  JointMotions S;
  switch (joint.kind) {
    case JointKind::kFree:
    case JointKind::kFixed:
      S.resize(6, 0);
      break;
    case JointKind::kHinge:
    case JointKind::kSlider:
      S = single_motion(joint, X_WB);
      break;
    case JointKind::kBall:
      S.resize(6, 3);
      S << -skew(X_WB.p - joint.anchor_W), Mat3::Identity();
      break;
  }
  return S;
}

Vec6 joint_rate(const Joint& joint, const Pose& X_start, const Pose& X_WB) noexcept {
  Vec6 rate = Vec6::Zero();
  switch (joint.kind) {
    case JointKind::kFree:
    case JointKind::kFixed:
      break;
    case JointKind::kHinge:
      rate.tail<3>() = joint.axis_W;
      break;
    case JointKind::kSlider:
      rate.head<3>() = joint.axis_W;
      break;
    case JointKind::kBall: {
      const Vec3 turned = log_rotation(X_WB.R * X_start.R.transpose());
      const double angle = turned.norm();
      if (angle > 0.0) rate.tail<3>() = turned / angle;
      break;
    }
  }
  return rate;
}

Vec6 joint_rate(const Body& body, const Pose& X_WB) noexcept {
  return joint_rate(body.joint, body.X_WB, X_WB);
}

Twist constrained_velocity(const Joint& joint, const Pose& X_WB, const Resistance& M,
                           const Twist& V) noexcept {
  if (joint.kind == JointKind::kFixed) return {};
  if (joint.kind == JointKind::kFree) return V;
  if (has_single_motion(joint)) {
    const Vec6 s = single_motion(joint, X_WB);
    const Vec6 Ms = M * s;
    return to_twist(s * (Ms.dot(to_vector(V)) / s.dot(Ms)));
  }
  const JointMotions S = joint_motions(joint, X_WB);
  const JointMotions MS = M * S;
  return to_twist(S * SmallMatrix(MS.transpose() * S).llt().solve(MS.transpose() * to_vector(V)));
}

Twist carried_velocity(const Joint& joint, const Pose& X_WB, const Twist& V) noexcept {
  switch (joint.kind) {
    case JointKind::kFixed:
      return {};
    case JointKind::kFree:
      break;
    case JointKind::kHinge:
    case JointKind::kSlider: {
      const Vec6 s = single_motion(joint, X_WB);
      const double rate = joint.axis_W.dot(joint.kind == JointKind::kHinge ? V.w : V.v);
      return to_twist(s * rate);
    }
    case JointKind::kBall:
      return {V.w.cross(X_WB.p - joint.anchor_W), V.w};
  }
  return V;
}

Pose constrained_pose(const Joint& joint, const Pose& X_start, const Pose& X_WB) noexcept {
  const Vec3& anchor = joint.anchor_W;
  const auto turned = [&](const Mat3& turn) -> Pose {
    return {turn * X_start.R, anchor + turn * (X_start.p - anchor)};
  };
  switch (joint.kind) {
    case JointKind::kFixed:
      return X_start;
    case JointKind::kFree:
      return renormalized(X_WB);
    case JointKind::kHinge:
      return turned(hinge_turn(joint, X_start.R, X_WB.R));
    case JointKind::kSlider:
      return {X_start.R, X_start.p + joint.axis_W * joint_position(joint, X_start, X_WB)};
    case JointKind::kBall:
      return turned(renormalized(X_WB).R * X_start.R.transpose());
  }
  return X_WB;
}

Pose constrained_pose(const Body& body, const Pose& X_WB) noexcept {
  return constrained_pose(body.joint, body.X_WB, X_WB);
}

}  // namespace tactum::inline v0_1
