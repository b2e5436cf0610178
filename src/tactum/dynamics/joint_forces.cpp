#include "tactum/dynamics/joint_forces.h"

namespace tactum::inline v0_1 {

JointForces joint_forces(const Body& body, const Pose& X_WB, double h) noexcept {
  JointForces forces;
  const Joint& joint = body.joint;
  if (joint.kind == JointKind::kFree || joint.kind == JointKind::kFixed) return forces;
  const bool has_spring = joint.stiffness != 0.0 && joint.kind != JointKind::kBall;
  // The position takes an arc tangent: it is computed only where a spring or a limit needs it.
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

}  // namespace tactum::inline v0_1
