#include "tactum/response/constraint_state.h"

#include <algorithm>

#include "tactum/base/tolerances.h"

namespace tactum::inline v0_1 {

using Index = std::size_t;

ConstraintState::ConstraintState(const World& world, const FrameSettings& settings)
    : problem(Index(settings.budget.max_contact_points), world.bodies.size()),
      position_problem(Index(settings.budget.max_contact_points), world.bodies.size(),
                       std::min(kMostUnknowns, world.bodies.size())),
      anchors(Index(settings.budget.max_contact_points)),
      planes(world.bodies.size(), Index(settings.budget.max_contact_points)),
      opening_share(tactum::opening_share(settings.dt_s)),
      trust{.length_m = settings.constraint.least_step_m * settings.smallest_scale()},
      hands(settings.hands()),
      corner_memory(settings.budget.capacity.patches / 4 + 1),
      rows(Index(settings.budget.max_contact_points)) {
  for (const Body& body : world.bodies)
    skin_m.push_back(body.moves() ? tolerances::kSkin * body.part->size : 0.0);
  const Index most_patches = settings.budget.capacity.patches;
  trial.X_WB.resize(world.bodies.size());
  trial.goes.assign(world.bodies.size(), 0);
  trial.turn.resize(world.bodies.size());
  trial.path_free.assign(world.bodies.size(), 1.0);
  trial.gap_now.reserve(most_patches);
  trial.gap.reserve(most_patches);
  trial.gap_least.reserve(most_patches);
  trial.gap_answer.reserve(most_patches);
}

FreeBodies::FreeBodies(const World& world, const FrameSettings& settings)
    : islands(world),
      forces(Index(settings.budget.max_contact_points), world.bodies.size()),
      newton(Index(settings.budget.max_contact_points), world.bodies.size()),
      momentum(world),
      near_grasped(world.bodies.size(), 0),
      unconverged(world.bodies.size(), 0),
      joined(world.bodies.size(), 0),
      detour(world.bodies.size()),
      A_contacts(world.bodies.size()),
      struck(world.bodies.size(), 0),
      hit(world.bodies.size(), 0),
      V_free(world.bodies.size()),
      A_free(world.bodies.size()),
      A_seen(world.bodies.size()),
      V_seen(world.bodies.size()),
      given_Ns(world.bodies.size(), Vec3::Zero()),
      bodies(world.bodies.size(), world.bodies.size()),
      rows(world.bodies.size(), Index(settings.budget.max_contact_points)),
      w_start(world.bodies.size(), Vec3::Zero()),
      w_free(world.bodies.size(), Vec3::Zero()),
      share(world.bodies.size(), 1.0),
      cut(world.bodies.size(), 0),
      settled(world.bodies.size(), 0) {
  for (const PairJoint& pair : world.pair_joints) joined[Index(pair.body)] = joined[Index(pair.parent)] = 1;
  gathered.reserve(Index(settings.budget.max_contact_points));
  patch_asked.reserve(settings.budget.capacity.patches);
  patch_closed.reserve(settings.budget.capacity.patches);
  patch_passed.reserve(settings.budget.capacity.patches);
}

Waiting::Waiting(const World& world, const FrameSettings& settings)
    : waits(world.bodies.size(), 0),
      waited(world.bodies.size(), 0),
      travel(world.bodies.size(), 0.0),
      X_rest(world.bodies.size()),
      rested(world.bodies.size(), 0),
      contacts_at_rest(world.bodies.size(), 0),
      V_kept(world.bodies.size()),
      first_patch(world.bodies.size() + 1, 0),
      next_patch(world.bodies.size() + 1, 0),
      contacts(world.bodies.size(), 0),
      hit(world.bodies.size(), 0) {
  order.reserve(world.bodies.size());
  patch_of.reserve(2 * settings.budget.capacity.patches);
  counted.reserve(settings.budget.capacity.patches);
}

Sleep::Sleep(const World& world)
    : X_still(world.bodies.size()),
      still(world.bodies.size(), 0),
      touched(world.bodies.size(), 0),
      touches(world.bodies.size(), 0),
      islands(world),
      restless(world.bodies.size(), 0) {}

ConstraintMemory::ConstraintMemory(const World& world, const FrameSettings& settings)
    : constraint(world, settings),
      free(world, settings),
      waiting(world, settings),
      sleep(world),
      contact_rows(settings.budget.capacity.patches, Index(settings.budget.max_contact_points)),
      impact_scratch(world.bodies.size()),
      motion_bound(world.bodies.size(), 0.0) {}

}  // namespace tactum::inline v0_1
