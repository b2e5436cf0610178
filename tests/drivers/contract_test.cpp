// What every driver of a real device must do, over all of them, each with its stand-in.

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "rig.h"
#include "support/standin_files.h"
#include "support/task_count.h"
#include "tactum/drivers/registry.h"

namespace tactum::contract_test {

class DriverContract : public ::testing::TestWithParam<RigMaker> {
 protected:
  /// The device, connected and open, with a guard that never acts.
  std::unique_ptr<Device> opened() {
    Result<std::unique_ptr<Device>> made = rig->make_unguarded();
    EXPECT_TRUE(made) << made.error().message();
    if (!made) return nullptr;
    const Result<void> open = (*made)->open();
    EXPECT_TRUE(open) << open.error().message();
    return open ? std::move(*made) : nullptr;
  }
  /// Reads once a virtual millisecond until `seen` accepts the sample; whether it did.
  template <class Seen>
  bool reads_until(Device& device, Seen seen) {
    return comes_true([&] { return device.read(now_s += 0.001, sample) && seen(sample); });
  }

  const int tasks_before = tasks_of_this_process();
  std::unique_ptr<DriverRig> rig = GetParam().make();
  DeviceSample sample;
  double now_s = 0.0;
};

TEST_P(DriverContract, TellsItsAbilitiesBeforeItIsOpened) {
  const Result<std::unique_ptr<Device>> device = rig->make_by_name();
  ASSERT_TRUE(device) << device.error().message();
  const DeviceInfo& info = (*device)->info();
  EXPECT_TRUE(info.is_hardware);
  EXPECT_TRUE(info.name.starts_with(GetParam().name)) << info.name;
  EXPECT_GT(info.workspace_radius_m, 0.0);
  EXPECT_EQ(info.actuates_force, info.max_force_N > 0.0);
  EXPECT_EQ(info.actuates_torque, info.max_torque_Nm > 0.0);
  EXPECT_TRUE(rig->commands_in_D().empty()) << "nothing is sent before it is opened";
}

TEST_P(DriverContract, AKnownPoseAndVelocityArriveInD) {
  const std::unique_ptr<Device> device = opened();
  ASSERT_TRUE(device);
  ASSERT_TRUE(reads_until(*device, [](const DeviceSample&) { return true; }));
  rig->go_to_known_pose();
  const Twist V = rig->known_velocity_in_D();
  ASSERT_TRUE(reads_until(*device,
                          [&V](const DeviceSample& now) {
                            return now.has_velocity &&
                                   (now.V_DH.v - V.v).norm() + (now.V_DH.w - V.w).norm() < 1e-9;
                          }))
      << sample.V_DH.v.transpose() << " / " << sample.V_DH.w.transpose();
  EXPECT_TRUE(sample.valid);
  const Pose X = rig->known_pose_in_D();
  const double moved = V.v.norm() * 0.05;  // one that leads by rate moves on from there
  EXPECT_NEAR((sample.X_DH.p - X.p).norm(), 0.0, device->info().actuates_force ? 1e-12 : moved);
  EXPECT_NEAR((sample.X_DH.R - X.R).norm(), 0.0, 1e-12);
  EXPECT_TRUE(plausible(sample.X_DH));
}

TEST_P(DriverContract, AWrenchAlongEachAxisArrivesWithItsSignAndUnit) {
  const std::unique_ptr<Device> device = opened();
  ASSERT_TRUE(device);
  if (!device->info().actuates_force) GTEST_SKIP() << "it only leads";
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {1.0, -1.0}) {
      Wrench F;
      F.f[axis] = sign * 2.0;
      if (device->info().actuates_torque) F.t[axis] = sign * 0.05;
      ASSERT_TRUE(device->write(F));
      ASSERT_TRUE(comes_true([&] {
        device->read(now_s += 0.001, sample);  // as a loop does
        const Wrench motors = rig->motors_in_D();
        return (motors.f - F.f).norm() < 1e-9 && (motors.t - F.t).norm() < 1e-9;
      })) << "axis "
          << axis << ": " << rig->motors_in_D().f.transpose() << " / " << rig->motors_in_D().t.transpose();
    }
}

TEST_P(DriverContract, ButtonsArePressedAndReleased) {
  const std::unique_ptr<Device> device = opened();
  ASSERT_TRUE(device);
  for (const int number : {0, 1}) {
    rig->press_button(number, true);
    EXPECT_TRUE(
        reads_until(*device, [number](const DeviceSample& now) { return now.buttons == 1u << number; }));
    rig->press_button(number, false);
    EXPECT_TRUE(reads_until(*device, [](const DeviceSample& now) { return now.buttons == 0; }));
  }
}

TEST_P(DriverContract, AWrenchBeyondTheLimitsOrNotFiniteNeverArrives) {
  const std::unique_ptr<Device> device = opened();
  ASSERT_TRUE(device);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(device->write({{1e6, 0, -1e6}, {1e3, 0, 0}}));
  EXPECT_FALSE(device->write({{nan, 0, 0}, {0, 0, 0}})) << "it says that it did not take it";
  EXPECT_FALSE(device->write({{0, 0, 0}, {0, nan, 0}}));
  EXPECT_TRUE(comes_true([&] { return rig->motors_in_D().f.isZero(0.0); })) << "and sends zero";
  device->close();
  for (const Wrench& sent : rig->commands_in_D()) {
    EXPECT_TRUE(sent.finite());
    EXPECT_LE(sent.f.norm(), device->info().max_force_N * (1 + 1e-12));
    EXPECT_LE(sent.t.norm(), device->info().max_torque_Nm * (1 + 1e-12));
  }
  EXPECT_TRUE(rig->broken_rules().empty()) << rig->broken_rules().front();
}

TEST_P(DriverContract, UnpluggedWhileRunningItFailsAndSaysSo) {
  const std::unique_ptr<Device> device = opened();
  ASSERT_TRUE(device);
  ASSERT_TRUE(reads_until(*device, [](const DeviceSample&) { return true; }));
  EXPECT_EQ(device->trouble(), "");
  rig->unplug();
  ASSERT_TRUE(comes_true([&] { return !device->read(now_s += 0.001, sample); }));
  EXPECT_FALSE(sample.valid);
  EXPECT_TRUE(comes_true([&] { return !device->write({{0.1, 0, 0}, {0, 0, 0}}); }));
  EXPECT_NE(device->trouble(), "");
  device->close();
}

TEST_P(DriverContract, ClosedTwiceItIsReleasedAndCanBeOpenedAgain) {
  const std::unique_ptr<Device> device = opened();
  ASSERT_TRUE(device);
  device->write({{1, 0, 0}, {0, 0, 0}});
  device->close();
  device->close();
  EXPECT_TRUE(rig->is_released());
  EXPECT_FALSE(device->read(1.0, sample));
  EXPECT_FALSE(device->write({}));
  if (device->info().actuates_force) {
    EXPECT_TRUE(rig->commands_in_D().back().f.isZero(0.0)) << "the last command is zero";
  }
  const Result<void> again = device->open();
  ASSERT_TRUE(again) << again.error().message();
  EXPECT_TRUE(reads_until(*device, [](const DeviceSample&) { return true; }));
  device->close();
  EXPECT_TRUE(rig->broken_rules().empty()) << rig->broken_rules().front();
}

TEST_P(DriverContract, LeavesNoThread) {
  const int with_standin = tasks_of_this_process();
  {
    Result<std::unique_ptr<Device>> device = rig->make_by_name();
    ASSERT_TRUE(device);
    ASSERT_TRUE((*device)->open());
    (*device)->close();
    EXPECT_EQ(tasks_of_this_process(), with_standin);
    ASSERT_TRUE((*device)->open()) << "and destroyed while it is open";
  }
  EXPECT_EQ(tasks_of_this_process(), with_standin);
  rig.reset();
  EXPECT_EQ(tasks_of_this_process(), tasks_before);
}

TEST_P(DriverContract, WhatIsAbsentIsToldWithItsCure) {
  const SetVariable nowhere(rig->variable(), "/nowhere/at/all.so");
  const Result<std::unique_ptr<Device>> device = make_device(GetParam().name, {});
  ASSERT_FALSE(device);
  for (const std::string& words : rig->words_when_absent())
    EXPECT_NE(device.error().message().find(words), std::string::npos) << device.error().message();
}

TEST_P(DriverContract, ALibraryThatLacksAFunctionIsRefusedByName) {
  if (rig->old_library().empty()) GTEST_SKIP() << "it needs no library";
  const SetVariable old(rig->variable(), rig->old_library());
  const Result<std::unique_ptr<Device>> device = make_device(GetParam().name, {});
  ASSERT_FALSE(device);
  for (const std::string& words :
       {rig->lacking_function(), rig->old_library(), std::string("a newer version")})
    EXPECT_NE(device.error().message().find(words), std::string::npos) << device.error().message();
}

TEST_P(DriverContract, TheSurveyFindsIt) {
  const std::vector<DriverSurvey> surveys = survey_drivers();
  const auto ours = std::find_if(surveys.begin(), surveys.end(),
                                 [](const DriverSurvey& survey) { return survey.driver == GetParam().name; });
  ASSERT_NE(ours, surveys.end());
  ASSERT_EQ(ours->found.size(), 1u) << ours->nothing;
  EXPECT_EQ(ours->nothing, "");
  const Result<std::unique_ptr<Device>> device = make_device(ours->found.front().name, {});
  ASSERT_TRUE(device) << "by the name that the survey tells: " << device.error().message();
  EXPECT_EQ((*device)->info().serial, ours->found.front().info.serial);
}

INSTANTIATE_TEST_SUITE_P(EveryDriver, DriverContract, ::testing::ValuesIn(every_rig()),
                         [](const ::testing::TestParamInfo<RigMaker>& info) {
                           return info.param.test_name();
                         });

}  // namespace tactum::contract_test
