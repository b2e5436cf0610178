#include "tactum/dynamics/joint_forces.h"

#include <algorithm>
#include <cmath>

namespace tactum::inline v0_1 {

JointForces joint_forces(const Body& body, const Pose& X_WB, const JointPosition& at, double inertia,
                         double h) noexcept {
  JointForces forces = joint_forces(body.joint, at, inertia, h);
  if (forces.acts) forces.rate = joint_rate(body, X_WB);
  return forces;
}

JointForces joint_forces(const Joint& joint, const JointPosition& at, double inertia, double h) noexcept {
  JointForces forces;
  if (joint.kind == JointKind::kFree || joint.kind == JointKind::kFixed) return forces;
  const bool has_spring = joint.stiffness != 0.0 && joint.kind != JointKind::kBall;
  forces.acts = has_spring || joint.limited() || joint.damping != 0.0 || joint.friction != 0.0;
  if (!forces.acts) return forces;
  forces.friction = joint.friction;
  if (joint.kind == JointKind::kBall) {
    forces.drag_about_ball = joint.damping;
  } else {
    const bool keeps_energy = joint.stiffness <= inertia;
    const double position = keeps_energy ? 0.75 * at.now + 0.25 * at.before : at.now;
    forces.drag = joint.damping + h * joint.stiffness * (keeps_energy ? 0.25 : 1.0);
    if (has_spring) forces.free_rate = -joint.stiffness * (position - joint.rest) / forces.drag;
  }
  forces.travel_down = at.now - joint.lower;
  forces.travel_up = joint.upper - at.now;
  return forces;
}

Twist most_by_spring(const Body& body, const Pose& X_WB, const JointPosition& at, double h) noexcept {
  const Joint& joint = body.joint;
  if (joint.stiffness == 0.0 || (joint.kind != JointKind::kHinge && joint.kind != JointKind::kSlider))
    return {};
  const Vec6 s = single_motion(joint, X_WB);
  const double inertia = s.dot(inertial_resistance(body, X_WB) * s);
  const double stretch = std::max(std::abs(at.now - joint.rest), std::abs(at.before - joint.rest));
  return to_twist(s * (h * joint.stiffness * stretch / inertia));
}

}  // namespace tactum::inline v0_1
