#include "tactum/haptics/constraint_response.h"

#include "tactum/haptics/constraint_step.h"

namespace tactum {

ConstraintResponse::ConstraintResponse(const World& world, const FrameSettings& settings, WorldState& bodies)
    : constraint(world, settings),
      free(world, settings),
      waiting(world, settings),
      sleep(world),
      contact_rows(settings.budget.capacity.patches,
                   static_cast<std::size_t>(settings.budget.max_contact_points)),
      mobility(world.bodies.size(), Mobility::Zero()),
      reach(world.bodies.size(), 0.0) {
  begin_midway(world, settings.dt_s, bodies);
}

std::span<const double> ConstraintResponse::bound_motion(const MotionInput& input,
                                                         WorldState& bodies) noexcept {
  pull_free_bodies(input, bodies);
  trusted_reach(input, bodies, *this);
  return reach;
}

void ConstraintResponse::step(const StepInput& input, GapOracle& gaps, WorldState& bodies,
                              FrameReport& report) noexcept {
  if (input.held.body != grasped_last) constraint.felt = {};
  grasped_last = input.held.body;
  ConstraintStep step{input, gaps, bodies, *this, report};
  respond_constrained(step);
}

Wrench ConstraintResponse::felt(const StepInput& input, const WorldState& /*bodies*/) noexcept {
  const Wrench pulses = impulses.next();
  return input.held.body < 0 ? Wrench{} : constraint.felt + pulses;
}

}  // namespace tactum
