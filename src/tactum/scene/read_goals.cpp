#include <fmt/format.h>

#include "tactum/scene/scene_sections.h"

namespace tactum {
namespace {

/// A hinged body by name.
int hinged_body(const TomlReader& table, const char* key, const World& world) {
  const int body = body_called(table, key, world);
  if (body >= 0 && world.bodies[static_cast<std::size_t>(body)].joint.kind != JointKind::kHinge)
    table.fail(key, "only a hinged body has an angle",
               fmt::format("\"{}\"", world.bodies[static_cast<std::size_t>(body)].name),
               "a body whose joint is a hinge");
  return body;
}

void read_turned(const TomlReader& table, const World& world, Goal& goal) {
  goal.body = hinged_body(table, "body", world);
  if (table.has("at_least_deg") == table.has("about_deg")) {
    table.fail(nullptr, table.section() + " must tell one angle", table.has("about_deg") ? "two" : "none",
               "at_least_deg, or about_deg with tolerance_deg");
    return;
  }
  if (table.has("at_least_deg")) {
    goal.kind = GoalKind::kTurned;
    goal.amount = radians(table.number("at_least_deg"));
  } else {
    goal.kind = GoalKind::kTurnedTo;
    goal.amount = radians(table.number("about_deg"));
    goal.tolerance = radians(table.number("tolerance_deg", {}, kPositive));
  }
}

void read_moved(const TomlReader& table, const Scene& scene, Goal& goal) {
  goal.body = body_called(table, "body", scene.world);
  if (goal.body < 0) return;
  goal.p_BQ = p_BP_of(scene.world.bodies[static_cast<std::size_t>(goal.body)]) +
              table.vector3("point_m", Vec3::Zero());
  if (table.has("at_least_m") == table.has("to_m")) {
    table.fail(nullptr, table.section() + " must tell one way", table.has("to_m") ? "two" : "none",
               "at_least_m along a direction, or to_m with tolerance_m");
    return;
  }
  if (table.has("at_least_m")) {
    goal.kind = GoalKind::kMovedBy;
    goal.vector_W = table.unit_vector3("direction");
    goal.amount = table.number("at_least_m", {}, kPositive);
  } else {
    goal.kind = GoalKind::kMovedTo;
    goal.vector_W = table.vector3("to_m");
    goal.tolerance = table.number("tolerance_m", {}, kPositive);
  }
}

void read_followed(const TomlReader& table, const World& world, Goal& goal) {
  goal.kind = GoalKind::kFollowed;
  goal.body = hinged_body(table, "body", world);
  goal.driver = hinged_body(table, "driver", world);
  goal.amount = table.number("ratio");
  goal.tolerance = radians(table.number("tolerance_deg", {}, kPositive));
}

}  // namespace

void read_goals(const TomlReader& root, Scene& scene) {
  const auto readers =
      root.tables("goal", {"kind", "body", "driver", "ratio", "at_least_deg", "about_deg", "tolerance_deg",
                           "at_least_m", "direction", "to_m", "tolerance_m", "point_m"});
  for (const TomlReader& table : readers) {
    Goal goal;
    const std::string kind = table.choice("kind", {}, {"turned", "moved", "touched", "picked", "followed"});
    if (table.errors()) return;
    if (kind == "turned") read_turned(table, scene.world, goal);
    if (kind == "moved") read_moved(table, scene, goal);
    if (kind == "touched" || kind == "picked") {
      goal.kind = kind == "touched" ? GoalKind::kTouched : GoalKind::kPicked;
      goal.body = body_called(table, "body", scene.world);
      goal.amount = 1.0;
    }
    if (kind == "followed") read_followed(table, scene.world, goal);
    scene.goals.push_back(goal);
  }
}

}  // namespace tactum
