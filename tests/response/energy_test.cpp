/// The energy of the coupling's spring, as the hand has it.
#include "tactum/response/energy.h"

#include <gtest/gtest.h>

namespace tactum {
namespace {

/// The energy of the two halves of the coupling, stretched by 2 mm and twisted by 0.03 rad.
double spring_energy(bool actuates_torque, const Wrench& felt, const Wrench& smoothed) {
  const World world;
  const WorldState bodies;
  FrameSettings settings;
  settings.coupling = {700.0, 0.4, 0.0, 0.0};
  settings.port.actuates_torque = actuates_torque;
  settings.safety.max_force_N = settings.safety.max_torque_Nm = 10.0;
  return stored_energy({.world = world,
                        .settings = settings,
                        .X_WB_start = {},
                        .bodies = bodies,
                        .hands = {},
                        .grasped = 0,
                        .to_hand = {{0, 0, 0.002}, {0.03, 0, 0}},
                        .V_WH = {},
                        .felt = felt,
                        .smoothed = smoothed})
      .spring_J;
}

constexpr double kStretched_J = 0.5 * 700.0 * 0.002 * 0.002, kTwisted_J = 0.5 * 0.4 * 0.03 * 0.03;
const Wrench kWhole{{0, 0, 1.4}, {0.012, 0, 0}};

TEST(StoredEnergy, IsThatOfTheStretchWhichIsFeltOrStillSmoothed) {
  for (const auto& [felt, smoothed] : {std::pair(kWhole, Wrench{}), {Wrench{}, kWhole}, {kWhole, kWhole}})
    EXPECT_NEAR(spring_energy(true, felt, smoothed), kStretched_J + kTwisted_J, 1e-15);
  EXPECT_EQ(spring_energy(true, {}, {}), 0.0);
  EXPECT_NEAR(spring_energy(true, kWhole * 0.5, {}), 0.25 * (kStretched_J + kTwisted_J), 1e-15);
}

/// A torque that nobody feels counts as it is booked, smoothed: a pulse of it stores nothing.
TEST(StoredEnergy, OfATorqueThatTheDeviceCannotExertIsThatOfTheSmoothedOne) {
  EXPECT_NEAR(spring_energy(false, kWhole, {}), kStretched_J, 1e-15);
  EXPECT_NEAR(spring_energy(false, {}, kWhole), kStretched_J + kTwisted_J, 1e-15);
}

}  // namespace
}  // namespace tactum
