#include "bench/stability.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "support/effort.h"

namespace tactum::bench::stability_test {
namespace {

std::vector<WallSetup> every_setup(bool turning) {
  std::vector<WallSetup> setups;
  for (const SimulatedDeviceModel& model : simulated_device_presets())
    for (const char* grip : {"loose", "medium", "firm"})
      if (!turning || model.max_torque_Nm > 0.0)
        setups.push_back({model, *hand_model(grip), 1000.0, turning});
  return setups;
}

std::string named(const WallSetup& setup) {
  return setup.device.name + ", " + setup.hand.name + (setup.turning ? ", turning" : "");
}

TEST(Stability, NearlyTheWholeBoundMakesNoEnergy) {
  const double seconds = testing::full_run() ? 60.0 : 2.4;
  for (const bool turning : {false, true})
    for (const WallSetup& setup : every_setup(turning)) {
      const WallTrial trial = try_wall(setup, 0.95 * wall_bound(setup), seconds);
      EXPECT_TRUE(trial.passive) << named(setup) << " " << trial.lowest_J;
      EXPECT_GT(trial.pressed, 0.0) << named(setup);
    }
}

TEST(Stability, NearlyTheWholeBoundComesToRestWhereFrictionStopsTheEncodersChatter) {
  for (const bool turning : {false, true})
    for (WallSetup setup : every_setup(turning)) {
      if (!(setup.device.max_torque_Nm > 0.0)) continue;
      // The Premium's friction holds against half an encoder step of 2.7 N/mm, no more.
      if (setup.device.name == "premium-1.5-6dof") {
        setup.device.encoder_step_m /= 20;
        setup.device.encoder_step_rad /= 20;
      }
      EXPECT_TRUE(try_wall(setup, 0.95 * wall_bound(setup)).at_rest) << named(setup);
    }
}

TEST(Stability, ACoarseEncoderChattersWithoutMakingEnergy) {
  WallSetup setup{*simulated_device_preset("premium-1.5-6dof"), *hand_model("firm"), 1000.0, false};
  const WallTrial trial = try_wall(setup, 0.95 * wall_bound(setup));
  EXPECT_FALSE(trial.at_rest);
  EXPECT_TRUE(trial.passive);
}

TEST(Stability, ThePublishedStiffnessAndOneNewtonAMillimetreAreHeldByAll) {
  for (const WallSetup& setup : every_setup(false))
    for (const double stiffness : {600.0, 1000.0}) {
      const WallTrial trial = try_wall(setup, stiffness);
      EXPECT_TRUE(trial.at_rest && trial.passive) << named(setup) << " " << stiffness;
    }
}

TEST(Stability, BeyondTheBoundEnergyIsMade) {
  for (const char* name : {"sigma.7", "omega.6"}) {
    const WallSetup setup{*simulated_device_preset(name), *hand_model("medium"), 1000.0, false};
    EXPECT_FALSE(try_wall(setup, 1.5 * wall_bound(setup)).passive) << name;
  }
}

TEST(Stability, TheStiffestWallWithoutEnergyIsThatOfTheBoundAtEveryRate) {
  for (const double rate_Hz :
       testing::full_run() ? std::vector<double>{1000, 2000, 4000, 10000} : std::vector<double>{1000}) {
    const WallRow row =
        stiffest_wall({*simulated_device_preset("sigma.7"), *hand_model("medium"), rate_Hz, false});
    EXPECT_GT(row.passive, 0.95 * row.bound) << rate_Hz;
    EXPECT_LT(row.passive, 1.3 * row.bound) << rate_Hz;
  }
}

TEST(Stability, ThePictureHasACurveForEveryRate) {
  const std::vector<WallRow> rows = {{"a", "medium", false, 1000, 0.0, 1, 2000, 2100, 2500},
                                     {"a", "medium", false, 1000, 1e-3, 1, 700, 750, 800},
                                     {"a", "medium", false, 4000, 0.0, 1, 8000, 8100, 9000},
                                     {"a", "medium", false, 4000, 1e-3, 1, 900, 950, 1000}};
  const std::string svg = z_width_plot(rows);
  EXPECT_NE(svg.find("a, pressed"), std::string::npos);
  EXPECT_NE(svg.find("4 kHz"), std::string::npos);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
}

TEST(Stability, AHandleThatIsReleasedWhilePressedComesToRestWithoutAStep) {
  for (const SimulatedDeviceModel& model : simulated_device_presets())
    for (const double force_N : testing::sampled(std::vector{5.0, 1.0}, 2))
      for (const double rate_Hz : testing::sampled(std::vector{1000.0, 4000.0}, 2)) {
        SCOPED_TRACE(::testing::Message() << model.name << ", " << force_N << " N, " << rate_Hz << " Hz");
        const ReleaseRow row = release_pressed(model, force_N, rate_Hz);
        EXPECT_GT(row.pressed_N, 0.6 * std::min(force_N, 0.8 * model.max_force_N));
        EXPECT_TRUE(row.at_rest) << "it still moves after " << row.rest_s << " s";
        EXPECT_LE(row.largest_step_N, row.slew_limit_N);
        EXPECT_GT(row.peak_m_per_s, 0.01) << "it is pushed away";
        EXPECT_LT(row.peak_m_per_s, 1.0);
      }
}

}  // namespace
}  // namespace tactum::bench::stability_test
