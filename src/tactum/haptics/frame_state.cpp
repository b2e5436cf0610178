#include "tactum/haptics/frame_state.h"

#include <algorithm>

namespace tactum::inline v0_1 {

FrameState::FrameState(const World& constant_world, const FrameSettings& settings,
                       StageObserver* stage_observer)
    : world(initial_state(constant_world)),
      X_WB_start(world.X_WB),
      contacts(constant_world, settings, world.X_WB),
      response(constant_world, settings, world),
      hand_inputs(settings.hands()),
      other_reports(settings.other_hands.size()),
      observer(stage_observer) {
  hand = begin_hand(settings);
  for (const HandSettings& other : settings.other_hands) other_hands.emplace_back().hand = begin_hand(other);
  // While nobody is there, a hand holds its part where that starts.
  for (std::size_t h = 0; h < settings.hands(); ++h)
    if (const Tool& tool = settings.hand(h).tool; tool.body >= 0)
      of_hand(h).hand.X_WH = world.X_WB[static_cast<std::size_t>(tool.body)] * tool.X_BH;
  // The first frame begins with the near pairs, as every other does.
  const std::vector<double> at_rest(constant_world.bodies.size(), 0.0);
  find_near_pairs(settings, world.X_WB, at_rest, {}, contacts);
  contacts.finder.find_patches(world.X_WB, settings.budget.max_exact_tests, response.points(),
                               contacts.priority);
}

std::span<const HandInput> track_hands(const World& world, const FrameSettings& settings,
                                       std::span<const HandSample> samples, FrameState& state) noexcept {
  const std::span<HandInput> hands = state.hand_inputs;
  for (std::size_t h = 0; h < hands.size(); ++h) {
    HandFrameState& own = state.of_hand(h);
    const std::span<const HandInput> earlier = hands.first(h);
    bool shared = false;
    for (std::size_t other = 0; other < hands.size(); ++other) {
      const Grasp& grasp = state.of_hand(other).hand.grasp;
      shared |= other != h && grasp.body == own.hand.grasp.body && !(grasp.left < 1.0);
    }
    const GraspedPart grasped = track_hand(world, settings.hand(h), settings.dt_s, samples[h],
                                           state.world.X_WB, own.hand, earlier, shared);
    hands[h] = hand_input(settings, settings.hand(h), grasped, state.contacts.finder.radii(),
                          own.port.booked.stiffness_share, own.hand.grasp.left);
    hands[h].bears_load = grasped.body >= 0 && !is_grasped(earlier, static_cast<std::size_t>(grasped.body));
    own.handle_moved = handle_motion(own.port, samples[h]);
    own.handle = {};
  }
  return hands;
}

bool some_known(std::span<const HandInput> hands) noexcept {
  return std::any_of(hands.begin(), hands.end(),
                     [](const HandInput& hand) { return hand.grasped.hand_known; });
}

}  // namespace tactum::inline v0_1
