#include "tactum/dynamics/joint.h"

#include <Eigen/Cholesky>

#include "tactum/math/screw.h"

namespace tactum {

Resistance inertial_resistance(const Body& body, const Pose& X_WB) noexcept {
  Resistance M = Resistance::Zero();
  M.topLeftCorner<3, 3>() = body.mass_kg * Mat3::Identity();
  M.bottomRightCorner<3, 3>() = X_WB.R * body.inertia_B * X_WB.R.transpose();
  return M;
}

Vec6 hinge_motion(const Joint& joint, const Pose& X_WB) noexcept {
  Vec6 S;
  S << joint.axis_W.cross(X_WB.p - joint.anchor_W), joint.axis_W;
  return S;
}

Mobility mobility(const Joint& joint, const Pose& X_WB, const Resistance& M) noexcept {
  switch (joint.kind) {
    case JointKind::kFixed:
      return Mobility::Zero();
    case JointKind::kFree:
      return M.llt().solve(Mat6::Identity());
    case JointKind::kHinge:
      break;
  }
  const Vec6 S = hinge_motion(joint, X_WB);
  return S * S.transpose() / S.dot(M * S);
}

Twist constrained_velocity(const Joint& joint, const Pose& X_WB, const Resistance& M,
                           const Twist& V) noexcept {
  switch (joint.kind) {
    case JointKind::kFixed:
      return {};
    case JointKind::kFree:
      return V;
    case JointKind::kHinge:
      break;
  }
  const Vec6 S = hinge_motion(joint, X_WB);
  const Vec6 MS = M * S;
  return to_twist(S * (MS.dot(to_vector(V)) / MS.dot(S)));
}

Pose constrained_pose(const Body& body, const Pose& X_WB) noexcept {
  switch (body.joint.kind) {
    case JointKind::kFixed:
      return body.X_WB;
    case JointKind::kFree:
      return renormalized(X_WB);
    case JointKind::kHinge:
      break;
  }
  const Mat3 turn = exp_rotation(body.joint.axis_W * hinge_angle(body, X_WB));
  const Vec3& anchor = body.joint.anchor_W;
  return {turn * body.X_WB.R, anchor + turn * (body.X_WB.p - anchor)};
}

}  // namespace tactum
