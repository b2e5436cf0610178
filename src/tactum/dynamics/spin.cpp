#include "tactum/dynamics/spin.h"

#include <Eigen/LU>

namespace tactum::inline v0_1 {

bool turns_freely(const Body& body) noexcept {
  return body.joint.kind == JointKind::kFree || body.joint.kind == JointKind::kBall;
}

Mat3 turning_inertia(const Body& body) noexcept {
  if (body.joint.kind == JointKind::kFree) return body.inertia_B;
  const Vec3 arm = body.X_WB.R.transpose() * (body.X_WB.p - body.joint.anchor_W);
  return body.inertia_B + body.mass_kg * (arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose());
}

Vec3 rate_midway(const Mat3& inertia_B, const Mat3& R_WB, const Vec3& w_WB, double h) noexcept {
  const Vec3 momentum = inertia_at(inertia_B, R_WB) * w_WB;
  const Mat3 compliance_B = inertia_B.inverse();
  Vec3 rate = w_WB;
  for (int round = 0; round < 3; ++round) {  // each round adds one order of h to the accuracy
    const Mat3 R_mid = exp_rotation(0.5 * h * rate) * R_WB;
    rate = rotated(R_mid, compliance_B * rotated_back(R_mid, momentum));
  }
  return rate;
}

Vec3 rate_after(const Mat3& inertia_B, const Mat3& R_WB, const Vec3& w_WB, const Vec3& impulse,
                const Mat3& R_WB_end) noexcept {
  const Vec3 momentum = inertia_at(inertia_B, R_WB) * w_WB + impulse;
  return inertia_at(inertia_B, R_WB_end).inverse() * momentum;
}

}  // namespace tactum::inline v0_1
