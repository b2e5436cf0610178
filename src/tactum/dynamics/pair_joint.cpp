#include "tactum/dynamics/pair_joint.h"

#include "tactum/math/screw.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// From the parent at the start to the parent now.
Pose moved_with_parent(const World& world, const PairJoint& pair, std::span<const Pose> X_WB) noexcept {
  return X_WB[Index(pair.parent)] * world.bodies[Index(pair.parent)].X_WB.inverse();
}

void lock_point(const Vec3& p_W, JointLocks& locks) noexcept {
  for (int i = 0; i < 3; ++i) locks.push_back({p_W, Vec3::Unit(i), Vec3::Zero()});
}

void lock_turn(const Vec3& p_W, JointLocks& locks) noexcept {
  for (int i = 0; i < 3; ++i) locks.push_back({p_W, Vec3::Zero(), Vec3::Unit(i)});
}

}  // namespace

Joint joint_on_parent(const World& world, const PairJoint& pair, std::span<const Pose> X_WB) noexcept {
  const Pose moved = moved_with_parent(world, pair, X_WB);
  Joint joint = pair.joint;
  joint.axis_W = moved.R * pair.joint.axis_W;
  joint.anchor_W = moved * pair.joint.anchor_W;
  return joint;
}

JointLocks joint_locks(const World& world, const PairJoint& pair, std::span<const Pose> X_WB) noexcept {
  const Joint joint = joint_on_parent(world, pair, X_WB);
  const Vec3& p_W = X_WB[Index(pair.body)].p;
  const Vec3 one = any_orthogonal(joint.axis_W);
  const Vec3 other = joint.axis_W.cross(one);
  JointLocks locks;
  switch (joint.kind) {
    case JointKind::kFree:
      break;
    case JointKind::kFixed:
      lock_point(p_W, locks);
      lock_turn(p_W, locks);
      break;
    case JointKind::kHinge:
      lock_point(joint.anchor_W, locks);
      locks.push_back({joint.anchor_W, Vec3::Zero(), one});
      locks.push_back({joint.anchor_W, Vec3::Zero(), other});
      break;
    case JointKind::kSlider:
      locks.push_back({p_W, one, Vec3::Zero()});
      locks.push_back({p_W, other, Vec3::Zero()});
      lock_turn(p_W, locks);
      break;
    case JointKind::kBall:
      lock_point(joint.anchor_W, locks);
      break;
  }
  return locks;
}

JointError joint_error(const World& world, const PairJoint& pair, std::span<const Pose> X_WB) noexcept {
  const Pose& X_start = world.bodies[Index(pair.body)].X_WB;
  const Pose moved = moved_with_parent(world, pair, X_WB);
  const Pose& X_WB_body = X_WB[Index(pair.body)];
  const bool about_anchor = pair.joint.kind == JointKind::kHinge || pair.joint.kind == JointKind::kBall;
  const Vec3& p_start = about_anchor ? pair.joint.anchor_W : X_start.p;
  JointError error;
  error.displacement = X_WB_body * (X_start.inverse() * p_start) - moved * p_start;
  const Vec3 axis_W = moved.R * pair.joint.axis_W;
  if (pair.joint.kind == JointKind::kSlider) error.displacement -= axis_W * axis_W.dot(error.displacement);
  if (pair.joint.kind == JointKind::kHinge)
    error.turn = axis_W.cross(X_WB_body.R * (X_start.R.transpose() * pair.joint.axis_W));
  if (pair.joint.kind == JointKind::kSlider || pair.joint.kind == JointKind::kFixed)
    error.turn = log_rotation(X_WB_body.R * (moved.R * X_start.R).transpose());
  return error;
}

Vec6 pair_rate(const World& world, const PairJoint& pair, std::span<const Pose> X_WB) noexcept {
  const Vec6 at_start =
      joint_rate(pair.joint, world.bodies[Index(pair.body)].X_WB, pose_by_parent(world, pair, X_WB));
  const Mat3 moved = X_WB[Index(pair.parent)].R * world.bodies[Index(pair.parent)].X_WB.R.transpose();
  Vec6 rate;
  rate << moved * at_start.head<3>(), moved * at_start.tail<3>();
  return rate;
}

Pose joined_pose(const World& world, const PairJoint& pair, std::span<const Pose> X_WB) noexcept {
  const Pose at_start =
      constrained_pose(pair.joint, world.bodies[Index(pair.body)].X_WB, pose_by_parent(world, pair, X_WB));
  return renormalized(moved_with_parent(world, pair, X_WB) * at_start);
}

bool has_drag(const Joint& joint) noexcept {
  return joint.damping > 0.0 || (joint.stiffness > 0.0 && joint.kind != JointKind::kBall);
}

JointUnknowns joint_unknowns(const Joint& joint) noexcept {
  if (joint.kind == JointKind::kFixed || joint.kind == JointKind::kFree) return {};
  if (joint.kind == JointKind::kBall) return {0, has_drag(joint) ? Index(3) : Index(0)};
  const Index own = (has_drag(joint) ? 1 : 0) + (joint.friction > 0.0 ? 1 : 0);
  return joint.kind == JointKind::kSlider ? JointUnknowns{own, 0} : JointUnknowns{0, own};
}

}  // namespace tactum::inline v0_1
