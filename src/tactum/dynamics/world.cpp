#include "tactum/dynamics/world.h"

#include <cmath>

#include "tactum/math/screw.h"

namespace tactum::inline v0_1 {
namespace {

/// Moves a position on to what the poses say, a hinge's to the nearest of the same angle.
void follow_position(JointKind kind, double measured, JointPosition& joint) noexcept {
  joint.before = joint.now;
  joint.now = measured;
  if (kind == JointKind::kHinge)
    joint.now += 2.0 * kPi * std::round((joint.before - joint.now) / (2.0 * kPi));
}

}  // namespace

WorldState initial_state(const World& world) {
  WorldState state;
  for (const Body& body : world.bodies) {
    state.X_WB.push_back(body.X_WB);
    state.V_WB.push_back(body.V_WB);
    state.joints.emplace_back();
  }
  return state;
}

double hinge_angle(const Joint& hinge, const Mat3& R_start, const Mat3& R) noexcept {
  // The rotation about the axis that comes closest to the turn since the start: for a turn exactly about the
  // axis, that turn. Twice the angle of (w, axis . vec) of its quaternion.
  const Quat turn(R * R_start.transpose());
  double angle = 2.0 * std::atan2(hinge.axis_W.dot(turn.vec()), turn.w());
  if (angle > kPi) angle -= 2.0 * kPi;
  if (angle <= -kPi) angle += 2.0 * kPi;
  return angle;
}

double joint_position(const Joint& joint, const Pose& X_start, const Pose& X_WB) noexcept {
  switch (joint.kind) {
    case JointKind::kFree:
    case JointKind::kFixed:
      return 0.0;
    case JointKind::kHinge:
      return hinge_angle(joint, X_start.R, X_WB.R);
    case JointKind::kSlider:
      return joint.axis_W.dot(X_WB.p - X_start.p);
    case JointKind::kBall:
      return log_rotation(X_WB.R * X_start.R.transpose()).norm();
  }
  return 0.0;
}

double hinge_angle(const Body& body, const Pose& X_WB) {
  return hinge_angle(body.joint, body.X_WB.R, X_WB.R);
}

double joint_position(const Body& body, const Pose& X_WB) {
  return joint_position(body.joint, body.X_WB, X_WB);
}

Pose pose_by_parent(const World& world, const PairJoint& pair, std::span<const Pose> X_WB) noexcept {
  const Pose& X_WB_parent = X_WB[static_cast<std::size_t>(pair.parent)];
  const Pose X_PB = X_WB_parent.inverse() * X_WB[static_cast<std::size_t>(pair.body)];
  return world.bodies[static_cast<std::size_t>(pair.parent)].X_WB * X_PB;
}

double pair_position(const World& world, const PairJoint& pair, std::span<const Pose> X_WB) noexcept {
  return joint_position(pair.joint, world.bodies[static_cast<std::size_t>(pair.body)].X_WB,
                        pose_by_parent(world, pair, X_WB));
}

void follow_joints(const World& world, WorldState& state) noexcept {
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const Body& body = world.bodies[i];
    if (!body.moves() || body.joint.kind == JointKind::kFree) continue;
    follow_position(body.joint.kind, joint_position(body, state.X_WB[i]), state.joints[i]);
  }
  for (const PairJoint& pair : world.pair_joints)
    follow_position(pair.joint.kind, pair_position(world, pair, state.X_WB),
                    state.joints[static_cast<std::size_t>(pair.body)]);
}

}  // namespace tactum::inline v0_1
