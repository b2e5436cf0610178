#pragma once
/// The forces of a joint on its body over one step: of its spring, damping, dry friction and limits, stated
/// once for every solver. All of it acts along one coordinate, the position of the joint (world.h); a ball is
/// damped about every axis.
///
/// With q the position at the start and u = rate . V the mean rate of the step, springs and dampers push with
///
///     force = -(k (q' - rest) + c u) = drag (free_rate - u).
///
/// For a body that a coupling pulls q' is the position at the end of the step, q + h u. For a body that has
/// momentum q' is the mean (q_-1 + 2 q + (q + h u)) / 4 of three positions, with q_-1 the one a step before:
/// then a spring keeps its energy to rounding, at every step [Newmark 1959]. A spring that is so stiff that
/// the step has fewer than 2 pi parts of its period is stated at the end of the step all the same, which
/// damps it: its swing is not resolved.

#include <limits>

#include "tactum/dynamics/joint.h"

namespace tactum::inline v0_1 {

struct JointForces {
  bool acts = false;             ///< false: the joint leaves its free motions alone
  Vec6 rate = Vec6::Zero();      ///< u = rate . V; see joint_rate()
  double drag = 0.0;             ///< of spring and damper [N s/m or N m s/rad]
  double free_rate = 0.0;        ///< at which they exert no force [m/s or rad/s]
  double drag_about_ball = 0.0;  ///< damping of a ball, about every axis [N m s/rad]
  double friction = 0.0;         ///< largest dry friction [N or N m]
  double travel_down = std::numeric_limits<double>::infinity();  ///< to the lower limit [m or rad]
  double travel_up = std::numeric_limits<double>::infinity();    ///< to the upper limit [m or rad]

  bool limited_down() const { return travel_down < std::numeric_limits<double>::infinity(); }
  bool limited_up() const { return travel_up < std::numeric_limits<double>::infinity(); }
};

/// For a step of `h` seconds from the pose X_WB and position `at`. `inertia` is that of the body along the
/// joint over h^2 [N/m or N m/rad]; 0 for one that has no momentum. A negative travel means that a limit has
/// been overrun.
/// The same of a joint without its rate, which stays zero.
JointForces joint_forces(const Joint& joint, const JointPosition& at, double inertia, double h) noexcept;
JointForces joint_forces(const Body& body, const Pose& X_WB, const JointPosition& at, double inertia,
                         double h) noexcept;

/// The largest change of velocity that the spring of a joint gives its body in a step of `h` seconds; zero
/// without a spring.
Twist most_by_spring(const Body& body, const Pose& X_WB, const JointPosition& at, double h) noexcept;

}  // namespace tactum::inline v0_1
