#include "tactum/drivers/command_guard.h"

#include <gtest/gtest.h>

#include <atomic>
#include <limits>

#include "support/task_count.h"

namespace tactum::command_guard_test {

DeviceInfo limited_device() {
  DeviceInfo info;
  info.actuates_force = info.actuates_torque = true;
  info.max_force_N = 5.0;
  info.max_torque_Nm = 0.1;
  return info;
}

TEST(CommandGate, PassesWhatIsWithinTheLimitsToTheBit) {
  const CommandGate gate(limited_device());
  const Wrench wanted{{1.0 / 3.0, -4.0, 0.1}, {0.05, 0.0, -1.0 / 30.0}};
  Wrench sent;
  EXPECT_TRUE(gate.pass(wanted, sent));
  EXPECT_EQ(sent.f, wanted.f);
  EXPECT_EQ(sent.t, wanted.t);
}

TEST(CommandGate, ShortensWhatIsBeyondThemAndKeepsItsDirection) {
  const CommandGate gate(limited_device());
  Wrench sent;
  EXPECT_TRUE(gate.pass({{30, 40, 0}, {0, 0, -2}}, sent));
  EXPECT_NEAR((sent.f - Vec3(3, 4, 0)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((sent.t - Vec3(0, 0, -0.1)).norm(), 0.0, 1e-12);
}

TEST(CommandGate, RefusesWhatIsNotFinite) {
  const CommandGate gate(limited_device());
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    for (const Wrench& wanted : {Wrench{{1, bad, 0}, {0, 0, 0}}, Wrench{{1, 0, 0}, {0, 0, bad}}}) {
      Wrench sent{{9, 9, 9}, {9, 9, 9}};
      EXPECT_FALSE(gate.pass(wanted, sent));
      EXPECT_TRUE(sent.f.isZero(0.0) && sent.t.isZero(0.0));
    }
}

TEST(CommandGate, ADeviceWithoutTorqueIsSentNone) {
  DeviceInfo info = limited_device();
  info.actuates_torque = false;
  Wrench sent;
  EXPECT_TRUE(CommandGate(info).pass({{1, 0, 0}, {0.05, 0, 0}}, sent));
  EXPECT_EQ(sent.f.x(), 1.0);
  EXPECT_TRUE(sent.t.isZero(0.0));
}

TEST(StaleGuardThread, SendsZeroWhileTheWriterIsSilentAndRefusesTheNextWrite) {
  std::atomic<int> zeros{0};
  StaleGuard guard;
  ASSERT_TRUE(guard.start(0.002, [&zeros] { ++zeros; }));
  ASSERT_TRUE(comes_true([&zeros] { return zeros >= 3; })) << "it goes on sending zero";
  EXPECT_FALSE(guard.on_time());
}

TEST(StaleGuardThread, LeavesAWriterThatIsOnTimeAlone) {
  int zeros = 0;
  StaleGuard guard;
  ASSERT_TRUE(guard.start(3600.0, [&zeros] { ++zeros; }));
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(guard.on_time());
  guard.stop();
  EXPECT_EQ(zeros, 0);
}

TEST(StaleGuardThread, LeavesNoThread) {
  const int before = tasks_of_this_process();
  {
    StaleGuard guard;
    ASSERT_TRUE(guard.start(0.01, [] {}));
    EXPECT_EQ(tasks_of_this_process(), before + 1);
    guard.stop();
    EXPECT_EQ(tasks_of_this_process(), before);
    ASSERT_TRUE(guard.start(0.01, [] {})) << "it can be started again";
  }
  EXPECT_EQ(tasks_of_this_process(), before);
}

}  // namespace tactum::command_guard_test
