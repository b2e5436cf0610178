#include "tactum/haptics/frame_state.h"

namespace tactum::inline v0_1 {

FrameState::FrameState(const World& constant_world, const FrameSettings& settings,
                       StageObserver* stage_observer)
    : world(initial_state(constant_world)),
      X_WB_start(world.X_WB),
      hand(begin_hand(settings)),
      contacts(constant_world, settings, world.X_WB),
      response(constant_world, settings, world),
      observer(stage_observer) {
  // The first frame begins with the near pairs, as every other does.
  const std::vector<double> at_rest(constant_world.bodies.size(), 0.0);
  find_near_pairs(settings, world.X_WB, at_rest, -1, contacts);
  contacts.finder.find_patches(world.X_WB, settings.budget.max_exact_tests, response.points(),
                               contacts.priority);
}

}  // namespace tactum::inline v0_1
