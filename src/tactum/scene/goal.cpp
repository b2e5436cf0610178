#include "tactum/scene/goal.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// Goals whose number at the end counts, not the best one meanwhile.
bool counts_at_end(GoalKind kind) { return kind == GoalKind::kTurnedTo || kind == GoalKind::kFollowed; }

/// Goals whose number must stay below the tolerance; the others must reach the amount.
bool smaller_is_better(GoalKind kind) {
  return kind == GoalKind::kTurnedTo || kind == GoalKind::kMovedTo || kind == GoalKind::kFollowed;
}

double degrees(double radians) { return radians * 180.0 / kPi; }

}  // namespace

GoalRecord::GoalRecord(const World& world, std::vector<Goal> goals)
    : goals_(std::move(goals)),
      angles_(world.bodies.size(), 0.0),
      touched_(world.bodies.size(), 0),
      picked_(world.bodies.size(), 0) {
  const WorldState start = initial_state(world);
  for (const Goal& goal : goals_) best_.push_back(measure(goal, world, start));
}

double GoalRecord::measure(const Goal& goal, const World& world, const WorldState& state) const noexcept {
  const Index body = Index(goal.body);
  const auto place = [&](const Pose& X_WB) -> Vec3 { return X_WB * goal.p_BQ; };
  switch (goal.kind) {
    case GoalKind::kTurned:
      return std::copysign(1.0, goal.amount) * angles_[body];
    case GoalKind::kTurnedTo:
      return std::abs(angles_[body] - goal.amount);
    case GoalKind::kMovedBy:
      return goal.vector_W.dot(place(state.X_WB[body]) - place(world.bodies[body].X_WB));
    case GoalKind::kMovedTo:
      return (place(state.X_WB[body]) - goal.vector_W).norm();
    case GoalKind::kTouched:
      return touched_[body];
    case GoalKind::kPicked:
      return picked_[body];
    case GoalKind::kFollowed:
      return std::abs(angles_[body] + goal.amount * angles_[Index(goal.driver)]);
  }
  return 0.0;
}

void GoalRecord::watch(const World& world, const WorldState& state, int grasped,
                       std::span<const ContactRow> rows) noexcept {
  if (grasped >= 0) {
    picked_[Index(grasped)] = 1;
    for (const ContactRow& row : rows) {
      if (!(row.impulse > 0.0) && !row.impact.seen) continue;
      if (row.body_a == grasped) touched_[Index(row.body_b)] = 1;
      if (row.body_b == grasped) touched_[Index(row.body_a)] = 1;
    }
  }
  for (Index b = 0; b < angles_.size(); ++b) {
    const Body& body = world.bodies[b];
    if (body.pair_joint >= 0) angles_[b] = state.joints[b].now;  // followed over full turns
    if (body.joint.kind != JointKind::kHinge) continue;
    // The whole turns that bring the measured angle nearest to the last one.
    const double measured = hinge_angle(body, state.X_WB[b]);
    angles_[b] = measured + 2.0 * kPi * std::round((angles_[b] - measured) / (2.0 * kPi));
  }
  for (Index g = 0; g < goals_.size(); ++g) {
    const double now = measure(goals_[g], world, state);
    if (counts_at_end(goals_[g].kind)) {
      best_[g] = now;
    } else {
      best_[g] = smaller_is_better(goals_[g].kind) ? std::min(best_[g], now) : std::max(best_[g], now);
    }
  }
}

bool GoalRecord::all_met() const noexcept {
  for (Index g = 0; g < goals_.size(); ++g)
    if (!met(g)) return false;
  return true;
}

bool is_met(const Goal& goal, double best) noexcept {
  return smaller_is_better(goal.kind) ? best <= goal.tolerance : best >= std::abs(goal.amount);
}

std::string describe_goal(const World& world, const Goal& g, double best) {
  const std::string& body = world.bodies[Index(g.body)].name;
  const char* verdict = is_met(g, best) ? "met" : "not met";
  switch (g.kind) {
    case GoalKind::kTurned:
      return fmt::format("{} turned by {:.2f} degrees, wanted {:.2f}: {}", body,
                         degrees(g.amount < 0.0 ? -best : best) + 0.0, degrees(g.amount), verdict);
    case GoalKind::kTurnedTo:
      return fmt::format("{} stopped {:.2f} degrees from {:.2f}, allowed {:.2f}: {}", body, degrees(best),
                         degrees(g.amount), degrees(g.tolerance), verdict);
    case GoalKind::kMovedBy:
      return fmt::format("{} moved by {:.2f} mm, wanted {:.2f}: {}", body, 1e3 * best, 1e3 * g.amount,
                         verdict);
    case GoalKind::kMovedTo:
      return fmt::format("{} came within {:.2f} mm of its place, wanted {:.2f}: {}", body, 1e3 * best,
                         1e3 * g.tolerance, verdict);
    case GoalKind::kTouched:
      return fmt::format("{} was {}: {}", body, best > 0.0 ? "touched" : "not touched", verdict);
    case GoalKind::kPicked:
      return fmt::format("{} was {}: {}", body, best > 0.0 ? "picked up" : "not picked up", verdict);
    case GoalKind::kFollowed:
      return fmt::format("{} followed {}: off by {:.2f} degrees, allowed {:.2f}: {}", body,
                         world.bodies[Index(g.driver)].name, degrees(best), degrees(g.tolerance), verdict);
  }
  return {};
}

}  // namespace tactum::inline v0_1
