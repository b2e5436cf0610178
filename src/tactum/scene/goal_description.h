#pragma once
/// The goals of the motion of a scene, as values in memory; goal.h defines when a goal is met.

#include <optional>
#include <string>
#include <variant>

#include "tactum/math/types.h"

namespace tactum::inline v0_1 {

/// A hinge: either it was once at an angle or beyond, or it ends near one.
struct TurnedGoal {
  static constexpr const char* kKind = "turned";
  std::string body = {};
  std::optional<double> at_least_rad = {};   ///< negative: in the other direction [rad]
  std::optional<double> about_rad = {};      ///< [rad]
  std::optional<double> tolerance_rad = {};  ///< of about_rad [rad]
};

/// A point of the part: either it once moved so far, or it once was at a place.
struct MovedGoal {
  static constexpr const char* kKind = "moved";
  std::string body = {};
  Vec3 point_m = Vec3::Zero();             ///< in the part's frame [m]
  std::optional<double> at_least_m = {};   ///< [m]
  std::optional<Vec3> direction = {};      ///< of at_least_m, in the world, of any length but zero [-]
  std::optional<Vec3> to_m = {};           ///< a place in the world [m]
  std::optional<double> tolerance_m = {};  ///< of to_m [m]
};

/// The grasped part once pushed the body.
struct TouchedGoal {
  static constexpr const char* kKind = "touched";
  std::string body = {};
};

/// The body was once grasped.
struct PickedGoal {
  static constexpr const char* kKind = "picked";
  std::string body = {};
};

/// A hinge ends at minus the ratio times the angle of another one.
struct FollowedGoal {
  static constexpr const char* kKind = "followed";
  std::string body = {};
  std::string driver = {};
  double ratio = 0.0;          ///< [-]
  double tolerance_rad = 0.0;  ///< [rad]
};

using GoalDescription = std::variant<TurnedGoal, MovedGoal, TouchedGoal, PickedGoal, FollowedGoal>;

}  // namespace tactum::inline v0_1
