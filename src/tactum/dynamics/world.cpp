#include "tactum/dynamics/world.h"

#include <cmath>

#include "tactum/math/screw.h"

namespace tactum::inline v0_1 {

WorldState initial_state(const World& world) {
  WorldState state;
  for (const Body& body : world.bodies) {
    state.X_WB.push_back(body.X_WB);
    state.V_WB.push_back(body.V_WB);
    state.joints.emplace_back();
  }
  return state;
}

double hinge_angle(const Body& body, const Pose& X_WB) {
  // The rotation about the axis that comes closest to the turn since the start: for a turn exactly about the
  // axis, that turn. Twice the angle of (w, axis . vec) of its quaternion.
  const Quat turn(X_WB.R * body.X_WB.R.transpose());
  double angle = 2.0 * std::atan2(body.joint.axis_W.dot(turn.vec()), turn.w());
  if (angle > kPi) angle -= 2.0 * kPi;
  if (angle <= -kPi) angle += 2.0 * kPi;
  return angle;
}

double joint_position(const Body& body, const Pose& X_WB) {
  switch (body.joint.kind) {
    case JointKind::kFree:
    case JointKind::kFixed:
      return 0.0;
    case JointKind::kHinge:
      return hinge_angle(body, X_WB);
    case JointKind::kSlider:
      return body.joint.axis_W.dot(X_WB.p - body.X_WB.p);
    case JointKind::kBall:
      return log_rotation(X_WB.R * body.X_WB.R.transpose()).norm();
  }
  return 0.0;
}

void follow_joints(const World& world, WorldState& state) noexcept {
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const Body& body = world.bodies[i];
    if (!body.moves() || body.joint.kind == JointKind::kFree) continue;
    JointPosition& joint = state.joints[i];
    joint.before = joint.now;
    joint.now = joint_position(body, state.X_WB[i]);
    if (body.joint.kind == JointKind::kHinge)
      joint.now += 2.0 * kPi * std::round((joint.before - joint.now) / (2.0 * kPi));
  }
}

}  // namespace tactum::inline v0_1
