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
                              FrameReport& report, std::span<HandReport> others) noexcept {
  for (std::size_t h = 0; h < input.hands.size(); ++h) {
    CoupledHand& hand = memory_.constraint.hands[h];
    if (input.hands[h].grasped.body == hand.body) continue;
    hand.felt = {};
    hand.impulses = {};
    hand.body = input.hands[h].grasped.body;
    memory_.constraint.trust.consecutive_rejections = 0;
  }
  ConstraintStep step{input, false, gaps, bodies, memory_, report, others};
  respond_constrained(step);
}

Wrench ConstraintResponse::felt(const StepInput& input, const PlacedHandle& /*handle*/,
                                std::size_t hand) noexcept {
  CoupledHand& coupled = memory_.constraint.hands[hand];
  const Wrench pulses = coupled.impulses.next();
  return input.hands[hand].grasped.body < 0 ? Wrench{} : coupled.felt + pulses;
}

}  // namespace tactum::inline v0_1
