#pragma once
/// The goals of a scene's motion, and whether they were met. A GoalRecord watches every frame, because a
/// hinge's angle is only known modulo a turn from one pose, and because some goals count when they were met
/// at any time.

#include <span>
#include <string>
#include <vector>

#include "tactum/dynamics/contact_row.h"
#include "tactum/dynamics/world.h"

namespace tactum::inline v0_1 {

enum class GoalKind {
  kTurned,    ///< at some time the hinge's angle was `amount` or beyond it (on the side of its sign)
  kTurnedTo,  ///< at the end the hinge's angle is within `tolerance` of `amount`
  kMovedBy,   ///< at some time the point had moved by `amount` or more along `vector_W`
  kMovedTo,   ///< at some time the point was within `tolerance` of `vector_W`
  kTouched,   ///< at some time the grasped part pushed it
  kPicked,    ///< at some time it was grasped
  kFollowed   ///< at the end the angle is -`amount` times the driver's, within `tolerance`
};

struct Goal {
  GoalKind kind = GoalKind::kTurned;
  int body = 0;                  ///< whose it is
  int driver = 0;                ///< kFollowed: the driving body
  Vec3 p_BQ = Vec3::Zero();      ///< kMoved*: the point of the body that is watched [m]
  Vec3 vector_W = Vec3::Zero();  ///< kMovedBy: unit direction [-]; kMovedTo: the place [m]
  double amount = 0.0;           ///< [rad], [m] or the ratio [-]
  double tolerance = 0.0;        ///< [rad] or [m]
};

/// Whether a goal is met by its best number so far (GoalRecord::best).
bool is_met(const Goal& goal, double best) noexcept;
/// "driven followed driving: off by 0.31 degrees, allowed 1.20: met", for that number.
std::string describe_goal(const World& world, const Goal& goal, double best);

/// The progress of the goals so far.
class GoalRecord {
 public:
  GoalRecord() = default;
  GoalRecord(const World& world, std::vector<Goal> goals);

  /// Takes one frame in. Hinges must turn by less than half a turn from frame to frame. No allocation.
  /// `grasped` is the body in the hand, -1: none; `rows` are the frame's contacts.
  void watch(const World& world, const WorldState& state, int grasped = -1,
             std::span<const ContactRow> rows = {}) noexcept;

  std::size_t size() const noexcept { return goals_.size(); }
  /// The number that decides the goal: the best so far, or the present one where the end counts.
  double best(std::size_t goal) const noexcept { return best_[goal]; }
  bool met(std::size_t goal) const noexcept { return is_met(goals_[goal], best_[goal]); }
  /// Whether all are met; true when there is none.
  bool all_met() const noexcept;
  /// Angle of a hinge since the start, full turns included [rad].
  double angle(std::size_t body) const noexcept { return angles_[body]; }
  /// As describe_goal says it.
  std::string describe(const World& world, std::size_t goal) const {
    return describe_goal(world, goals_[goal], best_[goal]);
  }

 private:
  /// The number that decides a goal now: an angle, a displacement, a distance, or an error.
  double measure(const Goal& goal, const World& world, const WorldState& state) const noexcept;

  std::vector<Goal> goals_;
  std::vector<double> angles_;          // of each body, unwrapped
  std::vector<char> touched_, picked_;  // of each body, so far
  std::vector<double> best_;  // of each goal: best so far, or the present value where the end counts
};

}  // namespace tactum::inline v0_1
