/// What reaches the hand in the shipped scenes, and the referee of the port's energy.
#include "bench/scene_feel.h"

#include <gtest/gtest.h>

#include <cstdio>

#include "bench/port_referee.h"
#include "support/effort.h"
#include "support/pressed_block.h"
#include "tactum/devices/simulated_device.h"
#include "tactum/haptics/coupling_gains.h"
#include "tactum/haptics/simulation.h"

namespace tactum::bench::scene_feel_test {
namespace {

/// Those of the scenes that are there, as far as they are not slow.
SceneFeelOptions sample_of_scenes() {
  SceneFeelOptions options;
  if (testing::full_run()) {
    options.scenes = {"gears",          "gears-rim",    "gears-pick",     "peg-in-hole", "peg-1mm",
                      "peg-100um",      "peg-20um",     "peg-7um",        "shaft",       "peg-round-h7g6",
                      "block-on-plate", "lock",         "scale",          "dominoes",    "moving-objects",
                      "dipole-field",   "vortex-field", "gears-involute", "nut-bolt"};
    return options;
  }
  options.scenes = {"block-on-plate", "lock", "peg-1mm", "moving-objects"};
  options.devices = {"premium-1.5-6dof", "touch"};
  if (!testing::kSanitized) options.devices.push_back("virtuose-6d");
  options.hands = {"loose", "firm"};
  options.most_s = testing::effort(6.6, 1.0);
  if (testing::kSanitized) options.hands = {"loose"};
  return options;
}

TEST(SceneFeel, WhatIsSentIsWhatWasComputedAndNoStepIsSentThatTheHandDidNotMake) {
  const Result<std::vector<SceneFeelRow>> rows =
      bench_scene_feel(sample_of_scenes(), [](const std::string&) {});
  ASSERT_TRUE(rows);
  double felt_N = 0.0;
  for (const SceneFeelRow& row : *rows) {
    SCOPED_TRACE(row.scene + " on " + row.device + ", " + row.hand + ", " + row.response);
    felt_N = std::max(felt_N, row.computed.largest_N);
    EXPECT_GT(row.frames, 100);
    EXPECT_EQ(row.unexplained, 0) << "of steps up to " << row.smoothed.largest_N << " N";
    EXPECT_EQ(row.sent.to_and_fro, 0) << "up to " << row.sent.largest_turn_N << " N";
    EXPECT_EQ(row.changed, 0);
    EXPECT_EQ(row.beyond_slew, 0);
    EXPECT_LT(row.generated_J, 1e-4);
    EXPECT_TRUE(row.least_share == 1.0 || row.response == "penalty") << "nothing was generated";
    if (row.scene == "block-on-plate" || row.scene == "peg-1mm") {
      EXPECT_LT(row.computed.to_and_fro, 60) << "steps of an encoder, that the coupling makes larger";
    }
  }
  EXPECT_GT(felt_N, testing::effort(0.2, 0.02))
      << "the computed force has steps that must not reach the hand";
}

/// A block on a plate, through a coupling that is too stiff for the device, in a hand that presses.
struct TooStiff {
  double bounds = 2.0;
  double delay_s = 0.0;
  bool kept = true;  // the balance
};

struct Refereed {
  double generated_J = 0.0, balance_J = 0.0, late_m_per_s = 0.0;
};

Refereed press(const TooStiff& c) {
  SimulatedDeviceModel model = *simulated_device_preset("premium-1.5-6dof");
  model.friction_N = 0.0;
  model.command_delay_s = c.delay_s;
  SimulatedDevice device(model, *hand_model("medium"), pressing_hand(0.01));
  EXPECT_TRUE(device.open());
  FrameSettings settings = settings_for(device.info(), 1000.0);
  settings.tool.body = 0;
  settings.coupling.damping_Ns_per_m = 0.0;
  settings.coupling.stiffness_N_per_m =
      c.bounds * stiffness_allowed(model.damping_Ns_per_m + hand_model("medium")->damping_Ns_per_m, 0.0, 1e-3,
                                   c.delay_s);
  settings.port.keeps_balance = c.kept;
  settings.smoothing.on = false;
  const std::unique_ptr<Simulation> simulation = std::move(*Simulation::make(block_over_plate(), settings));
  FrameTrace trace(simulation->world(), 1e-3, true);
  PortReferee referee(simulation->world(), simulation->settings(), trace);
  std::vector<double> row(trace.width());
  Refereed result;
  for (int i = 0; i < 3000; ++i) {
    DeviceSample sample;
    device.read(i * 1e-3, sample);
    device.write(simulation->step(sample));
    trace.take({simulation->report(), simulation->state(), simulation->settings()}, nullptr);
    while (trace.pop(row)) referee.look(row);
    if (i >= 2000) result.late_m_per_s = std::max(result.late_m_per_s, device.true_twist().v.norm());
  }
  result.generated_J = referee.generated_J();
  result.balance_J = referee.balance_J();
  return result;
}

TEST(PortReferee, SeesAWallThatSwingsAndSeesItComeToRest) {
  const Refereed wild = press({.bounds = 3.0, .delay_s = 1e-3, .kept = false}),
                 tame = press({.bounds = 3.0, .delay_s = 1e-3}), sound = press({.bounds = 0.05});
  std::printf(
      "  alone: %.4f J generated, %.3f m/s at last; kept: %.4f J, %.4f m/s; a twentieth of the bound: %.6f "
      "J\n",
      wild.generated_J, wild.late_m_per_s, tame.generated_J, tame.late_m_per_s, sound.generated_J);
  EXPECT_GT(wild.generated_J, 0.01);
  EXPECT_GT(wild.late_m_per_s, 0.02);
  EXPECT_LT(tame.late_m_per_s, 0.004);
  EXPECT_LT(tame.generated_J, 0.2 * wild.generated_J);
  EXPECT_LT(sound.generated_J, 1e-4);
}

}  // namespace
}  // namespace tactum::bench::scene_feel_test
