#include "tactum/drivers/registry.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>

#include "tactum/devices/replay_device.h"

namespace tactum {
namespace {

TEST(Registry, EveryListedSimulatedDeviceOpensAndMoves) {
  auto motion = std::make_shared<ScriptedMotion>();
  motion->move_to(0.2, {Mat3::Identity(), {0.01, 0, 0}});
  DeviceOptions options;
  options.hand_motion = motion;
  int made = 0;
  for (const DeviceListing& listing : list_devices()) {
    EXPECT_FALSE(listing.description.empty());
    if (listing.name.rfind("simulated", 0) != 0) continue;
    Result<std::unique_ptr<Device>> device = make_device(listing.name, options);
    ASSERT_TRUE(device) << device.error().message();
    ASSERT_TRUE((*device)->open());
    DeviceSample sample;
    for (int i = 0; i <= 300; ++i) ASSERT_TRUE((*device)->read(i * 0.001, sample));
    EXPECT_GT(sample.X_DH.p.x(), 0.005) << listing.name;
    (*device)->close();
    (*device)->close();
    EXPECT_FALSE((*device)->read(1.0, sample)) << "closed";
    ++made;
  }
  EXPECT_EQ(made, 5);
}

TEST(Registry, SimulatedAloneIsThePremium) {
  Result<std::unique_ptr<Device>> device = make_device("simulated", {});
  ASSERT_TRUE(device);
  EXPECT_EQ((*device)->info().name, "simulated premium-1.5-6dof");
}

TEST(Registry, UnknownNamesAreAnsweredWithWhatThereIs) {
  const Result<std::unique_ptr<Device>> device = make_device("phantom", {});
  ASSERT_FALSE(device);
  const std::string message = device.error().message();
  EXPECT_NE(message.find("'phantom'"), std::string::npos);
  for (const DeviceListing& listing : list_devices()) {
    EXPECT_NE(message.find(listing.name), std::string::npos) << listing.name;
  }
  const Result<std::unique_ptr<Device>> preset = make_device("simulated:omega.9", {});
  ASSERT_FALSE(preset);
  EXPECT_NE(preset.error().message().find("omega.6"), std::string::npos);
  DeviceOptions options;
  options.grip = "iron";
  EXPECT_FALSE(make_device("simulated", options));
  EXPECT_FALSE(make_device("replay:", options));
  EXPECT_FALSE(make_device("replay", options));
  EXPECT_FALSE(make_device("replay:/nowhere.csv", options));
  EXPECT_FALSE(make_device("", options));
}

TEST(Registry, ReplaysAFile) {
  const std::string path =
      (std::filesystem::path(testing::TempDir()) / "tactum_registry_replay.txt").string();
  std::ofstream(path) << "0 0 0 0 0 0 0 1\n1 0.1 0 0 0 0 0 1\n";
  Result<std::unique_ptr<Device>> device = make_device("replay:" + path, {});
  std::filesystem::remove(path);
  ASSERT_TRUE(device) << device.error().message();
  ASSERT_TRUE((*device)->open());
  EXPECT_TRUE((*device)->info().actuates_force) << "it takes what a device of its class takes";
  EXPECT_TRUE((*device)->info().actuates_torque);
  DeviceSample sample;
  ASSERT_TRUE((*device)->read(3.0, sample));
  EXPECT_EQ(sample.X_DH.p.x(), 0.0);
  ASSERT_TRUE((*device)->read(3.5, sample));
  EXPECT_NEAR(sample.X_DH.p.x(), 0.05, 1e-15);
}

std::shared_ptr<ScriptedMotion> straight() {
  auto motion = std::make_shared<ScriptedMotion>();
  motion->move_to(1.0, {Mat3::Identity(), {0.1, 0, 0}}, MotionProfile::kSteady);
  return motion;
}

TEST(ReplayDevice, RestsOrRepeatsAtTheEnd) {
  ReplaySettings settings;
  ReplayDevice resting("line", straight(), settings);
  settings.at_end = AtEnd::kRepeat;
  ReplayDevice repeating("line", straight(), settings);
  ASSERT_TRUE(resting.open());
  ASSERT_TRUE(repeating.open());
  DeviceSample sample;
  ASSERT_TRUE(resting.read(0.0, sample));
  ASSERT_TRUE(repeating.read(0.0, sample));
  EXPECT_NEAR(sample.V_DH.v.x(), 0.1, 1e-15);
  ASSERT_TRUE(repeating.read(2.25, sample));
  EXPECT_NEAR(sample.X_DH.p.x(), 0.025, 1e-15);
  EXPECT_FALSE(repeating.finished());
  ASSERT_TRUE(resting.read(2.25, sample));
  EXPECT_EQ(sample.X_DH.p.x(), 0.1);
  EXPECT_EQ(sample.V_DH.v.norm(), 0.0);
  EXPECT_TRUE(resting.finished());
}

TEST(ReplayDevice, LimitsAndCountsWhatItIsSent) {
  ReplayDevice device("line", straight(), {});
  EXPECT_FALSE(device.write({})) << "not open";
  ASSERT_TRUE(device.open());
  EXPECT_TRUE(device.write({{0, 1, 0}, {0.1, 0, 0}}));
  EXPECT_TRUE(device.write({{0, 17, 0}, {0, 0, 1}}));
  EXPECT_FALSE(device.write({{0, std::numeric_limits<double>::infinity(), 0}, {0, 0, 0}}));
  EXPECT_EQ(device.writes(), 2);
  EXPECT_EQ(device.saturated_writes(), 1);
  EXPECT_TRUE(device.write({{0, 17, 0}, {0, 0, 1}}));
  EXPECT_NEAR(device.last_wrench().f.y(), 8.5, 1e-15);
  EXPECT_NEAR(device.last_wrench().t.z(), 0.188, 1e-15);
}

}  // namespace
}  // namespace tactum
