#include "tactum/haptics/frame_state.h"

#include "tactum/haptics/response.h"

namespace tactum {
namespace {

std::vector<CollisionBody> collision_bodies(const World& world) {
  std::vector<CollisionBody> bodies;
  for (const Body& body : world.bodies) bodies.push_back({body.part.get(), body.moves()});
  return bodies;
}

}  // namespace

FrameState::FrameState(const World& constant_world, const FrameSettings& settings,
                       StageObserver* stage_observer)
    : world(initial_state(constant_world)),
      tool(settings.tool),
      finder(collision_bodies(constant_world), world.X_WB, settings.budget.rooms, settings.dt_s),
      observer(stage_observer),
      resistance(constant_world.bodies.size(), Resistance::Zero()),
      mobility(constant_world.bodies.size(), Mobility::Zero()),
      X_WB_start(world.X_WB),
      reach(constant_world.bodies.size(), 0.0),
      contacts(settings.budget.rooms.patches, static_cast<std::size_t>(settings.budget.max_contact_points)),
      constraint(constant_world, settings),
      free(constant_world, settings),
      waiting(constant_world, settings),
      sleep(constant_world) {
  if (settings.response == ResponseModel::kConstraint) begin_midway(constant_world, settings.dt_s, world);
  hand.X_WD = settings.workspace.X_WD;
  // The first frame begins with what is near, as every other does.
  finder.find_near_pairs(world.X_WB, reach, settings.penalty.min_tolerance_m);
  finder.find_patches(world.X_WB, settings.budget.max_exact_tests, points_wanted(settings), waiting.urgency);
  if (!settings.shading.on) return;
  bool some_bend = false;
  for (const Body& body : constant_world.bodies)
    some_bend |= shading.emplace_back(*body.part, settings.shading.crease_rad).bends();
  if (!some_bend) shading.clear();
}

}  // namespace tactum
