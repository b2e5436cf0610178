#pragma once
/// The joint between two bodies that move, as rows of the contact problem: one for each relative motion that
/// it does not allow, which holds with equality.
///
///     push . (x_body - x_parent) = -error
///
/// A row pushes on both bodies at one point and with opposite torques, so linear and angular momentum of the
/// two are kept to rounding. Its direction is that at the start of the step, its error that of the poses at
/// the end of it: solved again with the errors found there, until none is left, the step is that of SHAKE
/// [Ryckaert 1977], which keeps the energy of a swing, and no joint drifts.

#include "tactum/base/static_vector.h"
#include "tactum/dynamics/joint.h"

namespace tactum::inline v0_1 {

/// The force of a row per unit of its multiplier: a force at a point, and a torque beside it.
struct Push {
  Vec3 p_W = Vec3::Zero();     ///< [m]
  Vec3 force = Vec3::Zero();   ///< [-]
  Vec3 torque = Vec3::Zero();  ///< [m]
};

/// The joint as it stands now: its axis and anchor are moved with the parent.
Joint joint_on_parent(const World& world, const PairJoint& pair, std::span<const Pose> X_WB) noexcept;

/// What the joint does not allow: three to six pushes on the body, each a force or a torque.
using JointLocks = StaticVector<Push, 6>;
JointLocks joint_locks(const World& world, const PairJoint& pair, std::span<const Pose> X_WB) noexcept;

/// How far the body is from where the joint allows it: the displacement of the joint's point on it from that
/// on the parent [m], and the turn [rad].
struct JointError {
  Vec3 displacement = Vec3::Zero(), turn = Vec3::Zero();
  double along(const Push& lock) const { return lock.force.dot(displacement) + lock.torque.dot(turn); }
};
JointError joint_error(const World& world, const PairJoint& pair, std::span<const Pose> X_WB) noexcept;

/// The direction of the joint's position on the body, as joint_rate(); of its opposite on the parent.
Vec6 pair_rate(const World& world, const PairJoint& pair, std::span<const Pose> X_WB) noexcept;

/// The pose of the body that the joint allows and that is nearest to its own, with the parent where it is.
Pose joined_pose(const World& world, const PairJoint& pair, std::span<const Pose> X_WB) noexcept;

/// How many unknowns stand before and behind the six of the body of a pair joint (contact_problem.h): one for
/// spring and damper, three for the damper of a ball, one for dry friction.
struct JointUnknowns {
  std::size_t before = 0, behind = 0;
};
JointUnknowns joint_unknowns(const Joint& joint) noexcept;
bool has_drag(const Joint& joint) noexcept;

}  // namespace tactum::inline v0_1
