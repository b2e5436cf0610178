#pragma once
/// What the cases of bench/mechanics.h are made with.

#include <cmath>

#include "bench/mechanics.h"
#include "tactum/geometry/primitives.h"

namespace tactum::bench {

inline constexpr double kGravity = 9.81;  // [m/s^2]

/// A FreeMotion that is filled body by body. Bodies have the density of water.
class MechanicsScene {
 public:
  FreeMotion motion;  ///< friction, restitution and gravity may be set

  int add(const Polytope& shape, const Pose& X_WB, const Twist& V_WB = {}, const Joint& joint = {},
          double ball_radius_m = 0.0);
  int add_box(const Vec3& half_m, const Pose& X_WB, const Twist& V_WB = {}, const Joint& joint = {});
  int add_fixed_box(const Vec3& half_m, const Pose& X_WB);
  /// Gravity downwards, seen from a plane that rises towards -x by `slope_rad`.
  void incline(double slope_rad);
};

/// Moves a scene on for so long.
void run(MotionEngine& engine, double seconds);

/// The load on a fixed body, the mean over another tenth of a second [N].
double mean_load_N(MotionEngine& engine, int fixed_body);

/// Kinetic energy of the body in a state, as its engine tells velocities [J].
double kinetic_energy(const Body& body, const Pose& X_WB, const Twist& V_WB);
/// ... and its angular momentum about the centre of mass [N m s].
Vec3 angular_momentum(const Body& body, const Pose& X_WB, const Twist& V_WB);

std::vector<MechanicsCase> contact_cases();
std::vector<MechanicsCase> impact_cases();
std::vector<MechanicsCase> turning_cases();  ///< hinges, and a body that turns freely
std::vector<MechanicsCase> grasped_cases();  ///< of a grasped part

}  // namespace tactum::bench
