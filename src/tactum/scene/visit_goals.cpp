#include "tactum/scene/item_visitor.h"

namespace tactum::inline v0_1 {
namespace {

/// Of a goal that is met by reaching an amount, or at a value within a tolerance: one of the two.
void check_one(ItemVisitor& visitor, bool amount, bool value, const char* what, const char* expected) {
  if (amount == value) visitor.fail(nullptr, visitor.section() + what, value ? "two" : "none", expected);
}

}  // namespace

void visit_items(ItemVisitor& visitor, TurnedGoal& goal) {
  visitor.text("body", goal.body, Need::kRequired);
  visitor.angle("at_least_deg", goal.at_least_rad);
  visitor.angle("about_deg", goal.about_rad);
  visitor.angle("tolerance_deg", goal.tolerance_rad, kPositive);
  check_one(visitor, goal.at_least_rad.has_value(), goal.about_rad.has_value(), " must tell one angle",
            "at_least_deg, or about_deg with tolerance_deg");
  if (goal.about_rad && !goal.tolerance_rad) visitor.missing("tolerance_deg", "a number");
}

void visit_items(ItemVisitor& visitor, MovedGoal& goal) {
  visitor.text("body", goal.body, Need::kRequired);
  visitor.vector("point_m", goal.point_m);
  visitor.number("at_least_m", goal.at_least_m, kPositive);
  visitor.optional("direction", goal.direction,
                   [&](Vec3& direction) { visitor.direction("direction", direction, Need::kOptional); });
  visitor.vector("to_m", goal.to_m);
  visitor.number("tolerance_m", goal.tolerance_m, kPositive);
  check_one(visitor, goal.at_least_m.has_value(), goal.to_m.has_value(), " must tell one way",
            "at_least_m along a direction, or to_m with tolerance_m");
  if (goal.at_least_m && !goal.direction) visitor.missing("direction", "3 numbers");
  if (goal.to_m && !goal.tolerance_m) visitor.missing("tolerance_m", "a number");
}

void visit_items(ItemVisitor& visitor, TouchedGoal& goal) {
  visitor.text("body", goal.body, Need::kRequired);
}

void visit_items(ItemVisitor& visitor, PickedGoal& goal) { visitor.text("body", goal.body, Need::kRequired); }

void visit_items(ItemVisitor& visitor, FollowedGoal& goal) {
  visitor.text("body", goal.body, Need::kRequired);
  visitor.text("driver", goal.driver, Need::kRequired);
  visitor.number("ratio", goal.ratio, kAny, Need::kRequired);
  visitor.angle("tolerance_deg", goal.tolerance_rad, kPositive, Need::kRequired);
}

void visit_items(ItemVisitor& visitor, GoalDescription& goal) {
  visitor.kinds("kind", "goal", goal, Need::kRequired);
}

}  // namespace tactum::inline v0_1
