#include "tactum/drivers/touch.h"

#include <gtest/gtest.h>

#include "standins/standin_hd.h"
#include "support/standin_files.h"
#include "support/task_count.h"

namespace tactum::touch_test {

class TouchLoop : public ::testing::Test {
 protected:
  /// The stand-in, to be changed while the lock lives.
  struct Locked {
    standin::HdDevice& device;
    std::lock_guard<std::mutex> lock{device.mutex};
    standin::HdDevice* operator->() { return &device; }
  };
  Locked standin() { return {*loaded_.function<standin::HdDevice*()>("standin_hd_device")()}; }
  std::unique_ptr<Device> opened() {
    Result<std::unique_ptr<Device>> device = TouchDevice::connect({.name = "", .stale_after_s = 3600.0});
    EXPECT_TRUE(device) << device.error().message();
    if (!device) return nullptr;
    const Result<void> open = (*device)->open();
    EXPECT_TRUE(open) << open.error().message();
    return std::move(*device);
  }
  /// From now on the library calls the driver no more.
  void stop_ticks() { loaded_.function<void()>("standin_hd_tick")(); }
  template <class Seen>
  bool reads_until(Device& device, Seen seen) {
    return comes_true([&] { return device.read(now_s += 0.001, sample) && seen(sample); });
  }

  DeviceSample sample;
  double now_s = 0.0;

 private:
  LoadedStandin loaded_{"standin_hd"};
  SetVariable library_{"TACTUM_OPENHAPTICS_LIBRARY", standin_file("standin_hd")};
};

bool holds(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}

TEST_F(TouchLoop, AsksTheDeviceForItsLimitsAndWorkspace) {
  Result<std::unique_ptr<Device>> device = TouchDevice::connect({});
  ASSERT_TRUE(device);
  const DeviceInfo& info = (*device)->info();
  EXPECT_EQ(info.name, "3d-systems PHANTOM Premium 1.5 6DOF");
  EXPECT_EQ(info.serial, "50812");
  EXPECT_TRUE(info.senses_rotation && info.actuates_torque);
  EXPECT_EQ(info.max_force_N, 8.5);
  EXPECT_NEAR(info.max_torque_Nm, 0.188, 1e-12);
  EXPECT_NEAR(info.max_stiffness_N_per_m, 1000.0, 1e-9);
  EXPECT_NEAR(info.workspace_radius_m, 0.060, 1e-12) << "the least half of the box";
}

TEST_F(TouchLoop, AStrongDeviceIsAskedForNoMoreThanAHandBears) {
  standin()->max_force_N = 37.27;
  const Result<std::unique_ptr<Device>> device = TouchDevice::connect({});
  ASSERT_TRUE(device);
  EXPECT_EQ((*device)->info().max_force_N, TouchDevice::kMostForce_N);
}

TEST_F(TouchLoop, ADeviceThatCannotTurnItsHandleIsSentNoTorque) {
  standin()->six_dof = false;
  const std::unique_ptr<Device> device = opened();
  ASSERT_TRUE(device);
  EXPECT_FALSE(device->info().actuates_torque);
  EXPECT_TRUE(device->write({{1, 0, 0}, {0.1, 0, 0}}));
  EXPECT_TRUE(comes_true([this] { return standin()->motors[2] == 1.0; }));
  device->close();
  EXPECT_TRUE(standin()->broken_rules.empty());
}

TEST_F(TouchLoop, AnInkwellIsPreferredAndARefusedResetIsToldNotFatal) {
  standin()->calibration = 0x5001;
  standin()->calibration_styles = 1 | 4;
  opened()->close();
  EXPECT_EQ(standin()->last_style, 4u);

  standin()->calibration = 0x5001;
  standin()->calibration_styles = 1;
  const std::unique_ptr<Device> device = opened();
  ASSERT_TRUE(device);
  EXPECT_TRUE(reads_until(*device, [](const DeviceSample& now) { return !now.motors_on; }));
  EXPECT_TRUE(holds(device->trouble(), "not calibrated")) << device->trouble();
}

TEST_F(TouchLoop, UntilItIsCalibratedItIsSentZero) {
  standin()->calibration = 0x5002;  // the user must do something
  const std::unique_ptr<Device> device = opened();
  ASSERT_TRUE(device);
  EXPECT_TRUE(device->write({{1, 0, 0}, {0, 0, 0}}));
  const std::size_t sent = standin()->commands.size();
  ASSERT_TRUE(comes_true([&] { return standin()->commands.size() > sent + 2; }));
  for (const auto& F : standin()->commands) EXPECT_EQ(F[2], 0.0);
  standin()->calibration = 0x5000;  // the stylus is put into the inkwell
  EXPECT_TRUE(reads_until(*device, [](const DeviceSample& now) { return now.motors_on; }));
  EXPECT_EQ(device->trouble(), "");
}

TEST_F(TouchLoop, WarmMotorsAreReportedAsOff) {
  const std::unique_ptr<Device> device = opened();
  ASSERT_TRUE(device);
  ASSERT_TRUE(reads_until(*device, [](const DeviceSample& now) { return now.motors_on; }));
  standin()->overheats = true;
  EXPECT_TRUE(reads_until(*device, [](const DeviceSample& now) { return !now.motors_on; }));
  EXPECT_TRUE(holds(device->trouble(), "let it rest")) << device->trouble();
  standin()->overheats = false;
  EXPECT_TRUE(reads_until(*device, [](const DeviceSample& now) { return now.motors_on; }));
}

TEST_F(TouchLoop, ASampleKeepsItsTimeUntilThereIsANewOne) {
  const std::unique_ptr<Device> device = opened();
  ASSERT_TRUE(device);
  // Two reads faster than the library's millisecond: some pair of them sees the same sample.
  bool same = false;
  for (int i = 0; i < 100000 && !same; ++i) {
    ASSERT_TRUE(device->read(now_s += 0.001, sample));
    same = sample.time_s < now_s;
  }
  EXPECT_TRUE(same);
}

TEST_F(TouchLoop, AbsentOrUnknownItIsTold) {
  EXPECT_FALSE(TouchDevice::connect({.name = "Left Device"}));
  standin()->connected = false;
  const DriverSurvey survey = TouchDevice::survey();
  EXPECT_TRUE(survey.found.empty());
  for (const char* words : {"Device Fault", "Default PHANToM", "--install-udev"})
    EXPECT_TRUE(holds(survey.nothing, words)) << survey.nothing;
}

TEST_F(TouchLoop, TellsTheWrenchOfTheFrameBeforeWhereTheLibraryDoes) {
  {
    const std::unique_ptr<Device> device = opened();
    ASSERT_TRUE(device);
    EXPECT_TRUE(device->write({{1, -2, 0.5}, {0.0625, 0, -0.125}}));
    EXPECT_TRUE(reads_until(*device, [](const DeviceSample& now) {
      return now.has_delivered && now.F_D_delivered.f == Vec3(1, -2, 0.5) &&
             (now.F_D_delivered.t - Vec3(0.0625, 0, -0.125)).norm() < 1e-12;
    })) << sample.F_D_delivered.f.transpose();
    standin()->overheats = true;
    EXPECT_TRUE(reads_until(*device, [](const DeviceSample& now) {
      return now.has_delivered && now.F_D_delivered.f.isZero(0.0);
    })) << "it is what the motors exert, not what was asked for";
  }
  standin()->overheats = false;
  standin()->knows_last_wrench = false;
  const std::unique_ptr<Device> device = opened();
  ASSERT_TRUE(device);
  ASSERT_TRUE(reads_until(*device, [](const DeviceSample&) { return true; }));
  EXPECT_FALSE(sample.has_delivered);
  EXPECT_EQ(device->trouble(), "") << "that is no fault";
}

TEST_F(TouchLoop, AServoThreadThatFallsSilentIsALostDevice) {
  const std::unique_ptr<Device> device = opened();
  ASSERT_TRUE(device);
  ASSERT_TRUE(reads_until(*device, [](const DeviceSample&) { return true; }));
  stop_ticks();
  EXPECT_TRUE(comes_true([&] { return !device->read(now_s += 0.001, sample); }));
  EXPECT_FALSE(device->write({}));
  EXPECT_TRUE(holds(device->trouble(), "does not answer")) << device->trouble();
}

}  // namespace tactum::touch_test
