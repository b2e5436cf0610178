#include "tactum/dynamics/joint_forces.h"

#include <algorithm>
#include <cmath>

namespace tactum {

JointForces joint_forces(const Body& body, const Pose& X_WB, double h) noexcept {
  JointForces forces;
  const Joint& joint = body.joint;
  if (joint.kind == JointKind::kFree || joint.kind == JointKind::kFixed) return forces;
  const bool has_spring = joint.stiffness != 0.0 && joint.kind != JointKind::kBall;
  // The position takes an arc tangent: it is computed only where a spring or a limit asks for it.
  const bool by_position = has_spring || joint.limited();
  forces.acts = by_position || joint.damping != 0.0 || joint.friction != 0.0;
  if (!forces.acts) return forces;
  forces.rate = joint_rate(body, X_WB);
  forces.friction = joint.friction;
  const double position = by_position ? joint_position(body, X_WB) : 0.0;
  if (joint.kind == JointKind::kBall) {
    forces.drag_about_ball = joint.damping;
  } else {
    forces.drag = joint.damping + h * joint.stiffness;
    if (has_spring) forces.free_rate = -joint.stiffness * (position - joint.rest) / forces.drag;
  }
  forces.travel_down = position - joint.lower;
  forces.travel_up = joint.upper - position;
  return forces;
}

Twist after_joint(const Body& body, const Pose& X_WB, const Mobility& W, double h, const Twist& V) noexcept {
  const JointForces forces = joint_forces(body, X_WB, h);
  if (!forces.acts) return V;
  Vec6 after = to_vector(V);
  if (forces.drag_about_ball > 0.0) {
    const double mobile = W.bottomRightCorner<3, 3>().trace() / 3.0;
    const Vec3 lost = V.w * (1.0 / (1.0 + mobile * h * forces.drag_about_ball) - 1.0);
    after += joint_motions(body.joint, X_WB) * lost;
  }
  const double mobile = forces.rate.dot(W * forces.rate);
  if (!(mobile > 0.0)) return to_twist(after);
  const double before = forces.rate.dot(after);
  const double drag = mobile * h * forces.drag;
  double rate = (before + drag * forces.free_rate) / (1.0 + drag);
  const double most = forces.friction * h * mobile;
  rate = std::abs(rate) <= most ? 0.0 : rate - std::copysign(most, rate);
  rate = std::clamp(rate, std::min(0.0, -forces.travel_down / h), std::max(0.0, forces.travel_up / h));
  return to_twist(after + W * forces.rate * ((rate - before) / mobile));
}

}  // namespace tactum
