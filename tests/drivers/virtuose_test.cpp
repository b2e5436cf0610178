#include "tactum/drivers/virtuose.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "standins/standin_virtuose.h"
#include "support/standin_files.h"
#include "support/task_count.h"
#include "tactum/drivers/registry.h"

namespace tactum::virtuose_test {

class VirtuoseLoop : public ::testing::Test {
 protected:
  /// The stand-in, to be changed while the lock lives.
  struct Locked {
    standin::VirtuoseDevice& device;
    std::lock_guard<std::mutex> lock{device.mutex};
    standin::VirtuoseDevice* operator->() { return &device; }
  };
  Locked standin() { return {*loaded_.function<standin::VirtuoseDevice*()>("standin_virtuose_device")()}; }
  std::unique_ptr<Device> opened(double relays_s = 0.0) {
    Result<std::unique_ptr<Device>> device =
        VirtuoseDevice::connect({.host = "", .stale_after_s = 3600.0, .relays_s = relays_s});
    EXPECT_TRUE(device) << device.error().message();
    if (!device) return nullptr;
    const Result<void> open = (*device)->open();
    EXPECT_TRUE(open) << open.error().message();
    return open ? std::move(*device) : nullptr;
  }
  template <class Seen>
  bool reads_until(Device& device, Seen seen) {
    return comes_true([&] { return device.read(now_s += 0.001, sample) && seen(sample); });
  }

  DeviceSample sample;
  double now_s = 0.0;

 private:
  LoadedStandin loaded_{"standin_virtuose"};
  SetVariable library_{"TACTUM_VIRTUOSE_LIBRARY", standin_file("standin_virtuose")};
};

bool holds(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}
const auto off = [](const DeviceSample& now) { return !now.motors_on; };
const auto on = [](const DeviceSample& now) { return now.motors_on; };

TEST_F(VirtuoseLoop, TellsWhatTheDeviceIsAndWhereItWasReached) {
  const Result<std::unique_ptr<Device>> device = make_device("virtuose:10.1.2.3#5126", {});
  ASSERT_TRUE(device) << device.error().message();
  const DeviceInfo& info = (*device)->info();
  EXPECT_EQ(standin()->host, "10.1.2.3#5126");
  EXPECT_EQ(info.serial, "871");
  EXPECT_TRUE(info.senses_rotation && info.actuates_force && info.actuates_torque);
  EXPECT_EQ(info.max_force_N, VirtuoseDevice::kMostForce_N);
  EXPECT_FALSE(standin()->powered) << "no motor is on yet";
  EXPECT_FALSE(standin()->force_on);
}

TEST_F(VirtuoseLoop, OneOfThreeAxesHasNoTorque) {
  standin()->axes = 3;
  const std::unique_ptr<Device> device = opened();
  ASSERT_TRUE(device);
  EXPECT_FALSE(device->info().actuates_torque || device->info().senses_rotation);
  EXPECT_TRUE(device->write({{1, 0, 0}, {0.1, 0, 0}}));
  EXPECT_TRUE(comes_true([this] { return standin()->motors[0] == 1.0f; }));
  EXPECT_EQ(standin()->motors[3], 0.0f);
}

TEST_F(VirtuoseLoop, TheLimitsAreSetAndTheOrderIsKept) {
  const std::unique_ptr<Device> device = opened();
  ASSERT_TRUE(device);
  EXPECT_EQ(standin()->max_force_N, 10.0f);
  EXPECT_EQ(standin()->max_torque_Nm, 0.7f);
  EXPECT_TRUE(device->write({{-1e3, 1e3, 1e3}, {1e3, -1e3, 1e3}}));
  EXPECT_TRUE(comes_true([this] { return standin()->motors[0] < 0.0f; }));
  // A direction in which a force of 10 N grows when it is rounded to float.
  EXPECT_TRUE(device->write({{1e3, 4e3, 8e3}, {0, 0, 0}}));
  EXPECT_TRUE(comes_true([this] { return standin()->motors[0] > 0.0f; }));
  const std::array<float, 6> motors = standin()->motors;
  EXPECT_LE(Vec3(motors[0], motors[1], motors[2]).norm(), 10.0);
  device->close();
  EXPECT_TRUE(standin()->broken_rules.empty()) << standin()->broken_rules.front();
}

TEST_F(VirtuoseLoop, TheHandleIsAtTheOriginWhereItIsOpened) {
  const std::unique_ptr<Device> device = opened();
  ASSERT_TRUE(device);
  ASSERT_TRUE(reads_until(*device, on));
  EXPECT_EQ(sample.X_DH.p.norm(), 0.0);
}

TEST_F(VirtuoseLoop, UntilTheRelaysAreClosedNothingIsSent) {
  standin()->relays_ticks = 40;
  const std::unique_ptr<Device> device = opened(0.05);
  ASSERT_TRUE(device);
  ASSERT_TRUE(reads_until(*device, off));
  // What a loop would send without regard to the motors.
  ASSERT_TRUE(comes_true([&] { return device->write({{1, 0, 0}, {0, 0, 0}}); }));
  EXPECT_TRUE(reads_until(*device, on));
  EXPECT_TRUE(comes_true([this] { return standin()->motors[0] == 1.0f; }));
  EXPECT_TRUE(standin()->broken_rules.empty()) << standin()->broken_rules.front();
}

TEST_F(VirtuoseLoop, ReleasedItRestsAndHeldItPushesAgain) {
  const std::unique_ptr<Device> device = opened();
  ASSERT_TRUE(device);
  ASSERT_TRUE(reads_until(*device, on));
  EXPECT_EQ(device->trouble(), "");
  standin()->grip_sensed = false;
  ASSERT_TRUE(reads_until(*device, off));
  EXPECT_TRUE(holds(device->trouble(), "hold the handle")) << device->trouble();
  EXPECT_TRUE(device->write({{1, 0, 0}, {0, 0, 0}}));
  const std::size_t sent = standin()->commands.size();
  ASSERT_TRUE(comes_true([&] { return standin()->commands.size() > sent + 2; }));
  EXPECT_EQ(standin()->commands.back()[0], 0.0f);
  standin()->grip_sensed = true;
  EXPECT_TRUE(reads_until(*device, on));
  EXPECT_EQ(device->trouble(), "");
}

TEST_F(VirtuoseLoop, TheEmergencyStopAndLostPowerAreToldAndStayOff) {
  const std::unique_ptr<Device> device = opened();
  ASSERT_TRUE(device);
  ASSERT_TRUE(reads_until(*device, on));
  standin()->operational = false;
  ASSERT_TRUE(reads_until(*device, off));
  EXPECT_TRUE(holds(device->trouble(), "emergency stop")) << device->trouble();
  standin()->operational = true;
  EXPECT_TRUE(comes_true([&] { return holds(device->trouble(), "no power"); })) << device->trouble();
  EXPECT_TRUE(reads_until(*device, off)) << "it is not switched on by itself";
  device->close();
  ASSERT_TRUE(device->open());
  EXPECT_TRUE(reads_until(*device, on));
}

TEST_F(VirtuoseLoop, AControllerThatFallsSilentIsLost) {
  const std::unique_ptr<Device> device = opened();
  ASSERT_TRUE(device);
  ASSERT_TRUE(reads_until(*device, on));
  standin()->silent = true;
  EXPECT_TRUE(comes_true([&] { return !device->read(now_s += 0.001, sample); }));
  EXPECT_FALSE(device->write({}));
  EXPECT_TRUE(holds(device->trouble(), "does not answer")) << device->trouble();
}

TEST_F(VirtuoseLoop, AnyCallThatFailsWhileItRunsEndsIt) {
  for (const char* name : {"virtGetPhysicalPosition", "virtGetPhysicalSpeed", "virtGetDeadMan",
                           "virtGetEmergencyStop", "virtGetPowerOn", "virtSetForce"}) {
    standin()->failing = "";
    const std::unique_ptr<Device> device = opened();
    ASSERT_TRUE(device);
    ASSERT_TRUE(reads_until(*device, on));
    standin()->failing = name;
    EXPECT_TRUE(comes_true([&] { return !device->read(now_s += 0.001, sample); })) << name;
    EXPECT_TRUE(holds(device->trouble(), "communication error")) << device->trouble();
    standin()->failing = "";
  }
}

TEST_F(VirtuoseLoop, ABufferOfZerosIsNoPose) {
  const std::unique_ptr<Device> device = opened();
  ASSERT_TRUE(device);
  standin()->pose = {};
  EXPECT_TRUE(comes_true([&] { return !device->read(now_s += 0.001, sample); }));
}

TEST_F(VirtuoseLoop, WhatFailsAtTheStartIsToldAndReleased) {
  for (const char* name : {"virtSetIndexingMode", "virtSetForceFactor", "virtSetTimeStep", "virtSetBaseFrame",
                           "virtSetCommandType", "virtSaturateTorque", "virtEnableForceFeedback",
                           "virtSetPowerOn", "virtSetPeriodicFunction", "virtStartLoop"}) {
    Result<std::unique_ptr<Device>> device = VirtuoseDevice::connect({});
    ASSERT_TRUE(device);
    standin()->failing = name;
    const Result<void> open = (*device)->open();
    EXPECT_FALSE(open) << name;
    standin()->failing = "";
    const std::string said = open ? "" : open.error().message();
    EXPECT_TRUE(holds(said, "communication error")) << said;
    EXPECT_FALSE(standin()->open) << name;
    EXPECT_FALSE(standin()->running) << name;
  }
}

TEST_F(VirtuoseLoop, TellsTheWrenchOnTheHandWhereTheLibraryDoes) {
  {
    const std::unique_ptr<Device> device = opened();
    ASSERT_TRUE(device);
    ASSERT_TRUE(reads_until(*device, on));
    EXPECT_FALSE(sample.has_delivered) << "refused in this mode, which is no fault";
  }
  standin()->has_force = true;
  const std::unique_ptr<Device> device = opened();
  ASSERT_TRUE(device);
  EXPECT_TRUE(device->write({{1, -2, 0.5}, {0.25, 0, 0}}));
  EXPECT_TRUE(reads_until(*device, [](const DeviceSample& now) {
    return now.has_delivered && now.F_D_delivered.f == Vec3(1, -2, 0.5) && now.F_D_delivered.t.x() == 0.25;
  }));
}

TEST_F(VirtuoseLoop, AbsentOrTooOldItIsTold) {
  standin()->major = 3;
  const Result<std::unique_ptr<Device>> old = VirtuoseDevice::connect({});
  ASSERT_FALSE(old);
  EXPECT_TRUE(holds(old.error().message(), "VirtuoseAPI 4")) << old.error().message();
  standin()->major = 4;
  standin()->connected = false;
  const DriverSurvey survey = VirtuoseDevice::survey();
  EXPECT_TRUE(survey.found.empty());
  for (const char* words : {"no Virtuose answers", "communication error", "127.0.0.1#53210", "HOST#PORT"})
    EXPECT_TRUE(holds(survey.nothing, words)) << survey.nothing;
  standin()->connected = true;
  standin()->operational = false;
  ASSERT_EQ(VirtuoseDevice::survey().found.size(), 1u);
  EXPECT_TRUE(holds(VirtuoseDevice::survey().found.front().health, "emergency stop"));
}

}  // namespace tactum::virtuose_test
