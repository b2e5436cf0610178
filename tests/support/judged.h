#pragma once
/// A world that is stepped, and judged by a referee that knows triangles and topology only.

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "tactum/haptics/simulation.h"
#include "tactum/referee/crossing_referee.h"

namespace tactum::testing {

struct Judged {
  World world;
  FrameSettings settings;
  std::unique_ptr<Simulation> simulation;
  std::unique_ptr<CrossingReferee> referee;

  /// Starts with the world and the settings as they are then, where nothing may cross.
  void begin() {
    simulation = std::move(*Simulation::make(world, settings));
    std::vector<RefereedBody> bodies;
    for (const Body& body : world.bodies)
      bodies.push_back({&body.part->surface, body.moves(), body.no_contact_with});
    referee = std::make_unique<CrossingReferee>(bodies, simulation->state().world.X_WB);
    ASSERT_EQ(referee->crossing_at_start(), 0);
  }
  const Pose& X_WB(int body) const { return simulation->state().world.X_WB[static_cast<std::size_t>(body)]; }
};

}  // namespace tactum::testing
