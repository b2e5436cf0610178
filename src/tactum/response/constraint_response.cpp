#include "tactum/response/constraint_response.h"

#include "tactum/response/constraint.h"
#include "tactum/response/free_bodies.h"

namespace tactum::inline v0_1 {

ConstraintResponse::ConstraintResponse(const World& world, const FrameSettings& settings, WorldState& bodies)
    : memory_(world, settings) {
  begin_midway(world, settings.dt_s, bodies);
}

std::span<const double> ConstraintResponse::bound_motion(const MotionInput& input,
                                                         WorldState& bodies) noexcept {
  memory_.waiting.V_kept = bodies.V_WB;  // same size: nothing is allocated
  pull_free_bodies(input, bodies);
  bound_constrained_motion(input, bodies, memory_);
  return memory_.motion_bound;
}

void ConstraintResponse::step(const StepInput& input, GapOracle& gaps, WorldState& bodies,
                              FrameReport& report) noexcept {
  if (input.grasped.body != grasped_last_) {
    memory_.constraint.felt = {};
    memory_.impulses = {};
    memory_.constraint.trust.consecutive_rejections = 0;
  }
  grasped_last_ = input.grasped.body;
  ConstraintStep step{input, false, gaps, bodies, memory_, report};
  respond_constrained(step);
}

Wrench ConstraintResponse::felt(const StepInput& input, const PlacedHandle& /*handle*/) noexcept {
  const Wrench pulses = memory_.impulses.next();
  return input.grasped.body < 0 ? Wrench{} : memory_.constraint.felt + pulses;
}

}  // namespace tactum::inline v0_1
