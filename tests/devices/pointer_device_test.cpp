#include "tactum/devices/pointer_device.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tactum/drivers/registry.h"
#include "tactum/math/screw.h"

namespace tactum {
namespace {

std::unique_ptr<PointerDevice> make_pointer(std::shared_ptr<const HandMotion> script = nullptr) {
  return std::make_unique<PointerDevice>(*simulated_device_preset("omega.6"), *hand_model("firm"),
                                         std::move(script));
}

/// Runs from frame `from` for `count` frames of a millisecond; the last sample.
DeviceSample run(PointerDevice& device, int from, int count) {
  DeviceSample sample;
  for (int i = from; i < from + count; ++i) {
    EXPECT_TRUE(device.read(0.001 * i, sample));
    device.write({});
  }
  return sample;
}

TEST(PointerDevice, FollowsItsAimAndComesToRestThere) {
  const auto device = make_pointer();
  ASSERT_TRUE(device->open());
  run(*device, 0, 10);
  const Pose aim{exp_rotation({0.0, 0.3, 0.1}), {0.02, -0.01, 0.03}};
  device->aim(aim, 1);
  const DeviceSample sample = run(*device, 10, 1500);
  EXPECT_LT((sample.X_DH.p - aim.p).norm(), 2e-4);
  EXPECT_LT(log_rotation(sample.X_DH.R * aim.R.transpose()).norm(), 5e-3);
  EXPECT_EQ(sample.buttons, 1u);
}

TEST(PointerDevice, NeverFasterThanItsLimitsAndNeverOutOfReach) {
  const auto device = make_pointer();
  ASSERT_TRUE(device->open());
  DeviceSample before = run(*device, 0, 10);
  device->aim({exp_rotation({0.0, 0.0, 3.0}), {5.0, 0.0, 0.0}}, 0);
  for (int i = 10; i < 1500; ++i) {
    const DeviceSample now = run(*device, i, 1);
    const Twist V = twist_between(before.X_DH, now.X_DH, 0.001);
    // A swinging hand may overshoot the speed of what it follows, but not by much.
    EXPECT_LT(V.v.norm(), 1.6 * PointerDevice::kMaxSpeed_m_per_s) << i;
    EXPECT_LT(V.w.norm(), 1.8 * PointerDevice::kMaxTurn_rad_per_s) << i;
    EXPECT_LE(now.X_DH.p.norm(), device->info().workspace_radius_m + 1e-4);
    before = now;
  }
  EXPECT_NEAR(before.X_DH.p.norm(), device->info().workspace_radius_m, 1e-3);
}

TEST(PointerDevice, WhatIsNoPoseIsIgnoredAndRestStays) {
  const auto device = make_pointer();
  ASSERT_TRUE(device->open());
  run(*device, 0, 10);
  device->aim({Mat3::Identity(), {std::nan(""), 0.0, 0.0}}, 0);
  device->aim({Mat3::Zero(), Vec3::Zero()}, 0);
  EXPECT_FALSE(device->aimed());
  device->aim({Mat3::Identity(), {0.03, 0.0, 0.0}}, 0);
  run(*device, 10, 40);
  device->rest();
  const DeviceSample soon = run(*device, 50, 800);
  EXPECT_GT(soon.X_DH.p.x(), 0.002);
  EXPECT_LT(soon.X_DH.p.x(), 0.029);
  const DeviceSample later = run(*device, 850, 500);
  EXPECT_LT((later.X_DH.p - soon.X_DH.p).norm(), 1e-4);
}

TEST(PointerDevice, PlaysItsScriptForthAndBackUntilAimed) {
  auto script = std::make_shared<ScriptedMotion>();
  script->move_to(1.0, {Mat3::Identity(), {0.04, 0.0, 0.0}});
  const auto device = make_pointer(script);
  ASSERT_TRUE(device->open());
  EXPECT_NEAR(run(*device, 0, 1030).X_DH.p.x(), 0.04, 1e-3);
  EXPECT_NEAR(run(*device, 1030, 1000).X_DH.p.x(), 0.0, 1e-3);
  EXPECT_NEAR(run(*device, 2030, 1000).X_DH.p.x(), 0.04, 1e-3);
}

TEST(PointerDevice, TheSameCallsGiveTheSameBits) {
  DeviceSample last[2];
  for (DeviceSample& sample : last) {
    const auto device = make_pointer();
    ASSERT_TRUE(device->open());
    run(*device, 0, 10);
    device->aim({exp_rotation({0.1, 0.2, 0.3}), {0.01, 0.02, 0.03}}, 0);
    sample = run(*device, 10, 200);
  }
  EXPECT_EQ(last[0].X_DH.p, last[1].X_DH.p);
  EXPECT_EQ(last[0].X_DH.R, last[1].X_DH.R);
}

TEST(PointerDevice, IsMadeByName) {
  const Result<std::unique_ptr<Device>> device = make_device("pointer:sigma.7", {});
  ASSERT_TRUE(device);
  EXPECT_NE(dynamic_cast<PointerDevice*>(device->get()), nullptr);
  EXPECT_FALSE(make_device("pointer:spoon", {}));
}

}  // namespace
}  // namespace tactum
