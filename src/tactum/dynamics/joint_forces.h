#pragma once
/// The forces of a joint on its body over one step: of its spring, damping, dry friction and limits, stated
/// once for every solver. All of it acts along one coordinate, the position of the joint (world.h); a ball is
/// damped about every axis.
///
/// Springs and dampers are stated at the end of the step, so that they are stable however stiff:
///
///     force = -(k (q + h u - rest) + c u) = drag (free_rate - u),     drag = c + h k
///
/// with q the position at the start and u = rate . V the mean rate of the step.

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

/// For a step of `h` seconds from the pose X_WB. A negative travel means that a limit has been overrun.
JointForces joint_forces(const Body& body, const Pose& X_WB, double h) noexcept;

}  // namespace tactum::inline v0_1
