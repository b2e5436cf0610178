#pragma once
/// A grasped block of 20 x 14 x 10 mm over a fixed plate, and a hand that brings it down and presses: a
/// running loop with real contact force, for tests of its behaviour.

#include <memory>

#include "support/add_body.h"
#include "support/solid_box.h"
#include "tactum/devices/hand_motion.h"
#include "tactum/haptics/frame.h"
#include "tactum/math/screw.h"
#include "tactum/mesh/make_part.h"

namespace tactum {

inline constexpr double kBlockGap_m = 0.003;  ///< between block and plate at the start [m]

/// Body 0 is the block, body 1 the plate, whose top is at z = 0.
inline World block_over_plate() {
  World world;
  add_body(world, {.part = solid_box({0.010, 0.007, 0.005}),
                   .mass_kg = 0.05,
                   .X_WP = {Mat3::Identity(), {0, 0, 0.005 + kBlockGap_m}}});
  add_body(world, {.part = solid_box({0.05, 0.05, 0.01}),
                   .X_WP = {Mat3::Identity(), {0, 0, -0.01}},
                   .joint = {.kind = JointKind::kFixed}});
  return world;
}

/// Down in 0.5 s to `pressed_m` below touching, tilted and slid a little, and there for good.
inline std::shared_ptr<const HandMotion> pressing_hand(double pressed_m) {
  auto motion = std::make_shared<ScriptedMotion>();
  motion->move_to(0.5, {exp_rotation({0.05, 0.03, 0.1}), {0.004, -0.002, -kBlockGap_m - pressed_m}});
  return motion;
}

}  // namespace tactum
