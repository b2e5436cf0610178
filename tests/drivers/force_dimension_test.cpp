#include "tactum/drivers/force_dimension.h"

#include <gtest/gtest.h>

#include "standins/standin_dhd.h"
#include "support/standin_files.h"
#include "support/task_count.h"

namespace tactum::force_dimension_test {

class ForceDimension : public ::testing::Test {
 protected:
  standin::DhdDevice& standin() { return *loaded_.function<standin::DhdDevice*()>("standin_dhd_device")(); }
  Result<std::unique_ptr<Device>> connect(const std::string& serial = "") {
    return ForceDimensionDevice::connect({.serial = serial, .stale_after_s = 3600.0});
  }
  /// The error of opening it; empty when it opens.
  std::string refusal() {
    Result<std::unique_ptr<Device>> device = connect();
    if (!device) return device.error().message();
    const Result<void> opened = (*device)->open();
    return opened ? "" : opened.error().message();
  }

 private:
  LoadedStandin loaded_{"standin_dhd"};
  SetVariable library_{"TACTUM_FORCE_DIMENSION_LIBRARY", standin_file("standin_dhd")};
};

bool holds(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}

TEST_F(ForceDimension, TheMakersOwnLimitsAndWatchdogAreSetBeforeForcesAreOn) {
  Result<std::unique_ptr<Device>> device = connect();
  ASSERT_TRUE(device);
  EXPECT_FALSE(standin().force_on) << "connecting switches nothing on";
  ASSERT_TRUE((*device)->open());
  EXPECT_TRUE(standin().force_on);
  EXPECT_EQ(standin().max_force, 12.0);
  EXPECT_EQ(standin().max_torque, 0.2);
  EXPECT_TRUE(standin().gravity_compensated);
  EXPECT_NEAR(standin().watchdog_s, ForceDimensionDevice::kWatchdog_s, 1e-12);
  EXPECT_FALSE(standin().expert) << "expert mode is left again";
  (*device)->close();
  EXPECT_TRUE(standin().broken_rules.empty()) << standin().broken_rules.front();
}

TEST_F(ForceDimension, TheInertiaAtTheHandleIsAskedForInExpertMode) {
  const double masses[] = {0.31, 0.27, 0.35, 0.0004, 0.0005, 0.0003};
  for (std::size_t i = 0; i < 6; ++i) standin().inertia[7 * i] = masses[i];
  Result<std::unique_ptr<Device>> device = connect();
  ASSERT_TRUE(device);
  EXPECT_NEAR((*device)->info().handle.mass_kg, 0.27, 1e-12);
  EXPECT_NEAR((*device)->info().handle.inertia_kg_m2, 0.0003, 1e-12);
  EXPECT_FALSE(standin().expert) << "expert mode is left again";
  EXPECT_TRUE(standin().broken_rules.empty()) << standin().broken_rules.front();
  (*device)->close();
  standin().inertia = {};
  Result<std::unique_ptr<Device>> silent = connect();
  ASSERT_TRUE(silent);
  EXPECT_EQ((*silent)->info().handle.mass_kg, 0.0) << "unknown";
}

TEST_F(ForceDimension, OneThatIsNotCalibratedIsRefusedAndDoesNotMove) {
  standin().calibrated = false;
  EXPECT_TRUE(holds(refusal(), "not calibrated")) << refusal();
  EXPECT_TRUE(holds(refusal(), "HapticInit"));
  EXPECT_FALSE(standin().open);
  const DriverSurvey survey = ForceDimensionDevice::survey();
  ASSERT_EQ(survey.found.size(), 1u);
  EXPECT_TRUE(holds(survey.found.front().health, "HapticInit"));
}

TEST_F(ForceDimension, ForcesThatStayOffAreToldWithTheirCause) {
  standin().refuses_force = true;
  EXPECT_TRUE(holds(refusal(), "dead-man switch")) << refusal();
  EXPECT_FALSE(standin().open);
}

TEST_F(ForceDimension, HeldByAnotherProgramOrAbsentItIsTold) {
  standin().used_elsewhere = true;
  EXPECT_TRUE(holds(refusal(), "held by another program")) << refusal();
  standin().used_elsewhere = false;
  standin().connected = 0;
  EXPECT_TRUE(holds(refusal(), "--install-udev")) << refusal();
  EXPECT_TRUE(holds(ForceDimensionDevice::survey().nothing, "plug it in"));
}

TEST_F(ForceDimension, ASerialThatIsNotThereIsToldWithThoseThatAre) {
  const Result<std::unique_ptr<Device>> device = connect("77");
  ASSERT_FALSE(device);
  EXPECT_TRUE(holds(device.error().message(), "77") && holds(device.error().message(), "10042"));
  EXPECT_FALSE(standin().open) << "what was looked at is released";
}

TEST_F(ForceDimension, AnUnknownTypeIsTakenForAWeakOne) {
  standin().type = 127;
  Result<std::unique_ptr<Device>> device = connect();
  ASSERT_TRUE(device);
  EXPECT_LE((*device)->info().max_force_N, 8.0);
  EXPECT_LE((*device)->info().max_torque_Nm, 0.1);
}

TEST_F(ForceDimension, AWristThatIsOnlyMeasuredIsSentNoTorque) {
  standin().active_wrist = false;
  standin().type = 34;  // omega.6
  Result<std::unique_ptr<Device>> device = connect();
  ASSERT_TRUE(device);
  EXPECT_TRUE((*device)->info().senses_rotation);
  EXPECT_FALSE((*device)->info().actuates_torque);
  ASSERT_TRUE((*device)->open());
  EXPECT_TRUE((*device)->write({{1, 0, 0}, {0.1, 0.1, 0.1}}));
  EXPECT_EQ(standin().commands.back(), (std::array<double, 7>{1, 0, 0, 0, 0, 0, 0}));
}

TEST_F(ForceDimension, TellsWhatIsDeliveredTheGripAndWhenForcesGoOff) {
  standin().grip_rad = -0.2;  // that of a left-handed one
  Result<std::unique_ptr<Device>> device = connect();
  ASSERT_TRUE(device);
  ASSERT_TRUE((*device)->open());
  standin().watchdog_s = 0.0;  // this test may be slow
  ASSERT_TRUE((*device)->write({{3, 0, 0}, {0, 0, 0}}));
  DeviceSample sample;
  ASSERT_TRUE((*device)->read(0.0, sample));
  EXPECT_FALSE(sample.has_velocity) << "of one pose there is none";
  EXPECT_EQ(sample.grip_rad, 0.2);
  ASSERT_TRUE(sample.has_delivered);
  EXPECT_EQ(sample.F_D_delivered.f.x(), 3.0);
  EXPECT_TRUE(sample.motors_on);
  standin().force_on = false;
  standin().force_off_cause = 1;
  ASSERT_TRUE((*device)->read(0.001, sample));
  EXPECT_TRUE(sample.motors_on) << "the state is asked for every 10 ms";
  ASSERT_TRUE((*device)->read(0.011, sample));
  EXPECT_FALSE(sample.motors_on);
  EXPECT_EQ(sample.F_D_delivered.f.x(), 0.0) << "nothing is delivered, whatever is commanded";
  EXPECT_TRUE(holds((*device)->trouble(), "force button")) << (*device)->trouble();
}

TEST_F(ForceDimension, TheDevicesOwnWatchdogIsNoticed) {
  Result<std::unique_ptr<Device>> device = connect();
  ASSERT_TRUE(device);
  ASSERT_TRUE((*device)->open());
  DeviceSample sample;
  double now_s = 0.0;
  ASSERT_TRUE(comes_true([&] { return (*device)->read(now_s += 0.02, sample) && !sample.motors_on; }))
      << "nothing is written, and the guard of this device never acts";
  EXPECT_TRUE(holds((*device)->trouble(), "watchdog")) << (*device)->trouble();
  EXPECT_FALSE(standin().force_on) << "not before the loop has seen it";
  ASSERT_TRUE(comes_true([&] { return (*device)->read(now_s += 0.02, sample) && sample.motors_on; }));
  EXPECT_EQ(standin().commands.back(), (std::array<double, 7>{})) << "on again with a zero wrench";
}

TEST_F(ForceDimension, WhatTheUserSwitchedOffStaysOff) {
  standin().old_firmware = true;
  Result<std::unique_ptr<Device>> device = connect();
  ASSERT_TRUE(device);
  ASSERT_TRUE((*device)->open());
  standin().force_on = false;
  standin().force_off_cause = 1;  // its button
  DeviceSample sample;
  for (int i = 1; i <= 10; ++i) {
    ASSERT_TRUE((*device)->read(0.02 * i, sample));
    EXPECT_FALSE(sample.motors_on);
  }
  EXPECT_FALSE(standin().force_on);
}

TEST_F(ForceDimension, FirmwareWithoutWatchdogIsOpenedAllTheSame) {
  standin().old_firmware = true;
  EXPECT_EQ(refusal(), "");
  EXPECT_EQ(standin().watchdog_s, 0.0);
}

}  // namespace tactum::force_dimension_test
