#pragma once
/// Joints as the paper applies them: to the velocities at the start of the frame and to the poses at its end
/// [Gregory 2000, 6.2]. In between, the unknowns of the contact problem are the motions that the joint leaves
/// free.

#include "tactum/dynamics/world.h"

namespace tactum::inline v0_1 {

/// How a body resists: the symmetric positive matrix M of impulse = M (change of twist), about the centre of
/// mass, world axes, twist order (v, w). That of a rigid body is its inertia; that of a grasped proxy comes
/// from the coupling.
using Resistance = Mat6;

/// Mass and inertia at the present orientation.
Resistance inertial_resistance(const Body& body, const Pose& X_WB) noexcept;

/// The twists that a joint leaves free, one per column: per unit rate about a hinge's axis, along a slider's,
/// about a ball's centre and an axis of the world. No columns for a fixed body; a free body has no use for
/// them.
using JointMotions = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::ColMajor, 6, 3>;
JointMotions joint_motions(const Joint& joint, const Pose& X_WB) noexcept;

/// The one column of a hinge or slider.
Vec6 single_motion(const Joint& joint, const Pose& X_WB) noexcept;

/// From the nearest point of a hinge's axis to a point of the world [m].
inline Vec3 beside_axis(const Joint& hinge, const Vec3& p_W) noexcept {
  const Vec3 from_anchor = p_W - hinge.anchor_W;
  return from_anchor - hinge.axis_W * hinge.axis_W.dot(from_anchor);
}

/// The row that gives the rate of the joint's position from a twist: position' = rate . V. Zero where there
/// is none. For a ball it is along the axis about which the ball has turned.
Vec6 joint_rate(const Joint& joint, const Pose& X_start, const Pose& X_WB) noexcept;
/// The same for a body's joint to the world.
Vec6 joint_rate(const Body& body, const Pose& X_WB) noexcept;

/// The velocity the joint allows that is nearest to V in the metric of the resistance: constraints applied to
/// velocities at the start of the frame.
Twist constrained_velocity(const Joint& joint, const Pose& X_WB, const Resistance& M,
                           const Twist& V) noexcept;

/// The velocity at X_WB of a body that moved with V a step before, at another pose: a joint's rate is kept,
/// not the direction of the velocity.
Twist carried_velocity(const Joint& joint, const Pose& X_WB, const Twist& V) noexcept;

/// The pose that a joint allows which is nearest to X_WB, of a body that was at X_start at the start:
/// constraints applied to poses at the end of the frame.
Pose constrained_pose(const Joint& joint, const Pose& X_start, const Pose& X_WB) noexcept;
/// The same for a body's joint to the world.
Pose constrained_pose(const Body& body, const Pose& X_WB) noexcept;

inline Vec6 to_vector(const Twist& V) {
  Vec6 v;
  v << V.v, V.w;
  return v;
}
inline Twist to_twist(const Vec6& v) { return {v.head<3>(), v.tail<3>()}; }

}  // namespace tactum::inline v0_1
