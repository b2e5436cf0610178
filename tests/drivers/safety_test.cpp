// What reaches a hand when a loop is killed, stands still, or computes nonsense, with every driver.

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <limits>

#include "rig.h"
#include "support/task_count.h"
#include "tactum/loop/loop_thread.h"
#include "tactum/loop/safety.h"

namespace tactum::driver_safety_test {

/// Wants a constant force, sends what the safety stage allows; at one frame something happens.
class PushingFrame final : public HapticFrame {
 public:
  explicit PushingFrame(const DeviceInfo& info) : limits_(safety_limits(info)) {}
  Wrench run(const DeviceSample& sample, const FrameTick& tick) noexcept override {
    if (tick.index == happens_at && happens) happens();
    Wrench wanted;
    wanted.f = {0.5 * limits_.max_force_N, 0, 0};
    std::uint32_t flags = 0;
    const Wrench sent = safe_wrench(limits_, state_, safety_input(sample, tick, wanted), flags);
    frames = tick.index;
    const double nan = std::numeric_limits<double>::quiet_NaN();
    return sends_nonsense ? Wrench{{nan, 0, 0}, {0, 0, 0}} : sent;
  }
  std::uint64_t happens_at = 0;
  std::function<void()> happens;
  std::atomic<bool> sends_nonsense{false};
  std::atomic<std::uint64_t> frames{0};

 private:
  SafetyLimits limits_;
  SafetyState state_;
};

class DriverSafetyLoop : public ::testing::TestWithParam<RigMaker> {
 protected:
  void SetUp() override {
    rig = GetParam().make();
    Result<std::unique_ptr<Device>> made = rig->make_by_name();
    ASSERT_TRUE(made) << made.error().message();
    device = std::move(*made);
    if (!device->info().actuates_force) GTEST_SKIP() << "it only leads";
  }
  bool rests() {
    return comes_true([this] { return rig->motors_in_D().f.isZero(0.0); });
  }
  /// Whether the motors push.
  bool pushes() {
    return comes_true([this] { return rig->motors_in_D().f.norm() > 0.0; });
  }
  /// Every command is within the limits, and rises from the last no faster than the start ramp and the slew
  /// limit let it; it may fall to zero at any time. What is between two commands took at least a period,
  /// since a frame sends no more than one; a library with a thread of its own may leave some out.
  void expect_gentle(const std::vector<Wrench>& commands) {
    ASSERT_FALSE(commands.empty());
    const SafetyLimits limits = safety_limits(device->info());
    const double step_N = 0.5 * limits.max_force_N * kPeriod_s / limits.start_ramp_s;
    double last_N = 0.0, largest_N = 0.0;
    for (const Wrench& F : commands) {
      ASSERT_TRUE(F.finite());
      const double force_N = F.f.norm();
      EXPECT_LE(force_N, device->info().max_force_N);
      EXPECT_LE(force_N, last_N + step_N * rig->most_frames_between_commands() * (1 + 1e-9))
          << "of " << limits.max_force_N;
      last_N = force_N;
      largest_N = std::max(largest_N, force_N);
    }
    EXPECT_GT(largest_N, 0.0) << "it has pushed";
    EXPECT_TRUE(commands.back().f.isZero(0.0)) << "the last is zero";
  }

  static constexpr double kPeriod_s = 0.001;
  std::unique_ptr<DriverRig> rig;
  std::unique_ptr<Device> device;
};

TEST_P(DriverSafetyLoop, StartsFromZeroAndEndsAtZero) {
  PushingFrame frame(device->info());
  LoopThread loop;
  ASSERT_TRUE(loop.start(*device, frame, {}));
  EXPECT_TRUE(pushes());
  loop.stop();
  EXPECT_TRUE(rests());
  EXPECT_TRUE(rig->is_released());
  expect_gentle(rig->commands_in_D());
  EXPECT_TRUE(rig->broken_rules().empty()) << rig->broken_rules().front();
}

TEST_P(DriverSafetyLoop, AKilledLoopLeavesNoWrench) {
  ASSERT_TRUE(device->open());
  // The loop's thread writes until the device pushes, and is gone without a word. A last write that was
  // refused would have sent zero itself.
  ASSERT_TRUE(comes_true([this] {
    const bool taken = device->write({{1.0, 0, 0}, {0, 0, 0}});
    const std::vector<Wrench> commands = rig->commands_in_D();
    return taken && !commands.empty() && commands.back().f.x() > 0.0;
  }));
  EXPECT_TRUE(rests());
  EXPECT_FALSE(device->write({{1.0, 0, 0}, {0, 0, 0}})) << "the first write after that is refused";
  EXPECT_TRUE(rests());
}

TEST_P(DriverSafetyLoop, AStalledLoopLeavesNoWrenchAndBeginsAnew) {
  PushingFrame frame(device->info());
  std::atomic<bool> rested{false};
  frame.happens_at = 100;
  frame.happens = [this, &rested] { rested = rests(); };
  LoopThread loop;
  ASSERT_TRUE(loop.start(*device, frame, {}));
  ASSERT_TRUE(comes_true([&frame] { return frame.frames > 200; }));
  loop.stop();
  EXPECT_TRUE(rested) << "while the loop stood still";
  EXPECT_TRUE(rests());
  expect_gentle(rig->commands_in_D());
}

TEST_P(DriverSafetyLoop, NonsenseIsNeverSent) {
  PushingFrame frame(device->info());
  LoopThread loop;
  ASSERT_TRUE(loop.start(*device, frame, {}));
  ASSERT_TRUE(pushes());
  frame.sends_nonsense = true;
  EXPECT_TRUE(comes_true([&loop] { return !loop.status().running; })) << "a loop of refused wrenches ends";
  EXPECT_TRUE(loop.status().device_lost);
  loop.stop();
  EXPECT_TRUE(rests());
  expect_gentle(rig->commands_in_D());
}

TEST_P(DriverSafetyLoop, UnpluggedItEndsTheLoop) {
  PushingFrame frame(device->info());
  LoopThread loop;
  ASSERT_TRUE(loop.start(*device, frame, {}));
  ASSERT_TRUE(pushes());
  rig->unplug();
  EXPECT_TRUE(comes_true([&loop] { return !loop.status().running; }));
  EXPECT_TRUE(loop.status().device_lost);
  loop.stop();
  EXPECT_TRUE(rests()) << "by its own watchdog";
  EXPECT_NE(device->trouble(), "");
}

INSTANTIATE_TEST_SUITE_P(EveryDriver, DriverSafetyLoop, ::testing::ValuesIn(every_rig()),
                         [](const ::testing::TestParamInfo<RigMaker>& info) {
                           return info.param.test_name();
                         });

}  // namespace tactum::driver_safety_test
