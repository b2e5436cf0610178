#include <fmt/format.h>

#include "tactum/scene/scene_builder.h"

namespace tactum::inline v0_1 {
namespace {

/// Goals of bodies by index, from those by name; `path` is that of the goal.
class GoalMaker {
 public:
  GoalMaker(SceneBuilder& builder, const std::string& path, const World& world)
      : builder_(builder), path_(path), world_(world) {}

  Goal operator()(const TurnedGoal& wanted) const {
    Goal goal;
    goal.body = hinged_body("body", wanted.body);
    goal.kind = wanted.at_least_rad ? GoalKind::kTurned : GoalKind::kTurnedTo;
    goal.amount = wanted.at_least_rad ? *wanted.at_least_rad : *wanted.about_rad;
    if (wanted.about_rad) goal.tolerance = *wanted.tolerance_rad;
    return goal;
  }
  Goal operator()(const MovedGoal& wanted) const {
    Goal goal;
    goal.body = body("body", wanted.body);
    if (goal.body < 0) return goal;
    goal.p_BQ = p_BP_of(world_.bodies[static_cast<std::size_t>(goal.body)]) + wanted.point_m;
    if (wanted.at_least_m) {
      goal.kind = GoalKind::kMovedBy;
      goal.vector_W = *wanted.direction / wanted.direction->norm();
      goal.amount = *wanted.at_least_m;
    } else {
      goal.kind = GoalKind::kMovedTo;
      goal.vector_W = *wanted.to_m;
      goal.tolerance = *wanted.tolerance_m;
    }
    return goal;
  }
  Goal operator()(const TouchedGoal& wanted) const { return once(GoalKind::kTouched, wanted.body); }
  Goal operator()(const PickedGoal& wanted) const { return once(GoalKind::kPicked, wanted.body); }
  Goal operator()(const FollowedGoal& wanted) const {
    Goal goal;
    goal.kind = GoalKind::kFollowed;
    goal.body = hinged_body("body", wanted.body);
    goal.driver = hinged_body("driver", wanted.driver);
    goal.amount = wanted.ratio;
    goal.tolerance = wanted.tolerance_rad;
    return goal;
  }

 private:
  int body(const char* key, const std::string& name) const {
    return builder_.find_body(item_path(path_, key), name, world_);
  }
  int hinged_body(const char* key, const std::string& name) const {
    const int index = body(key, name);
    if (index >= 0 && world_.joint_of(index).kind != JointKind::kHinge)
      builder_.fail(item_path(path_, key), "only a hinged body has an angle", fmt::format("\"{}\"", name),
                    "a body whose joint is a hinge");
    return index;
  }
  Goal once(GoalKind kind, const std::string& name) const {
    Goal goal;
    goal.kind = kind;
    goal.body = body("body", name);
    goal.amount = 1.0;
    return goal;
  }

  SceneBuilder& builder_;
  const std::string& path_;
  const World& world_;
};

}  // namespace

void build_goals(SceneBuilder& builder, Scene& scene) {
  for (const GoalDescription& goal : builder.description().goals) {
    const std::string path = item_path("", "goal", scene.goals.size());
    scene.goals.push_back(std::visit(GoalMaker(builder, path, scene.world), goal));
  }
}

}  // namespace tactum::inline v0_1
