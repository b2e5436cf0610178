#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <limits>
#include <thread>
#include <vector>

#include "tactum/base/assert.h"
#include "tactum/drivers/registry.h"
#include "tactum/loop/loop_thread.h"
#include "tactum/loop/safety.h"

namespace tactum::loop_test {
namespace {

/// A device that records its calls. Used by the loop's thread, read after it has ended.
class FakeDevice final : public Device {
 public:
  Result<void> open() override {
    if (refuses_open) return Error{"the fake device is unplugged", "", "", ""};
    is_open = true;
    ++opened;
    return {};
  }
  void close() noexcept override {
    if (is_open) ++closed;
    is_open = false;
  }
  const DeviceInfo& info() const noexcept override { return info_; }
  bool read(double now_s, DeviceSample& sample) noexcept override {
    sample.time_s = now_s;
    sample.valid = true;
    return true;
  }
  bool write(const Wrench& F_D) noexcept override {
    ++writes;
    last = F_D;
    if (reports_zero && is_zero(F_D)) std::fputs("zero wrench written\n", stderr);
    return is_open && (writes_before_lost < 0 || writes <= writes_before_lost);
  }

  bool refuses_open = false;
  bool reports_zero = false;
  bool is_open = false;
  int writes_before_lost = -1;
  int opened = 0;
  int closed = 0;
  int writes = 0;
  Wrench last;

 private:
  DeviceInfo info_;
};

/// Pushes with one newton; led down by tenths when asked to stop.
class PushingFrame : public HapticFrame {
 public:
  Wrench run(const DeviceSample& sample, const FrameTick& tick) noexcept override {
    ++frames;
    if (tick.late) ++late_frames;
    if (tick.index < 4096) times[tick.index] = sample.time_s;
    if (slow_frame == static_cast<long>(tick.index)) std::this_thread::sleep_for(slow_for);
    if (tick.stop && force > 0.0) force = stops ? std::max(0.0, force - 0.1) : force;
    forces_fell_evenly = forces_fell_evenly && last - force < 0.11;
    last = force;
    return {{force, 0, 0}, {0, 0, 0}};
  }

  long frames = 0;
  long late_frames = 0;
  long slow_frame = -1;
  std::chrono::milliseconds slow_for{0};
  bool stops = true;
  bool forces_fell_evenly = true;
  double force = 1.0;
  double last = 1.0;
  double times[4096] = {};
};

/// Settings that do not ask the machine for privileges; a shared one may starve others.
LoopSettings plain_settings() {
  LoopSettings settings;
  settings.realtime.realtime = false;
  settings.realtime.lock_memory = false;
  settings.late_limit_s = 100.0;  // only the test about lateness cares
  return settings;
}

void wait_for_frames(const LoopThread& loop, std::uint64_t frames) {
  while (loop.status().frames < frames && loop.status().running) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

class Recorder final : public LoopObserver {
 public:
  bool after_frame(const FrameRecord& record) noexcept override {
    now_s.push_back(record.tick.now_s);
    negative_times += record.frame_time_s < 0.0;
    return now_s.size() != stop_after;
  }
  std::vector<double> now_s;
  std::size_t stop_after = 0;
  int negative_times = 0;
};

TEST(VirtualLoop, RunsEveryFrameOnTheGridAndEndsWithZero) {
  FakeDevice device;
  PushingFrame frame;
  Recorder recorder;
  const Result<VirtualRun> run = run_virtual(device, frame, 1000.0, 2500, &recorder);
  ASSERT_TRUE(run);
  EXPECT_EQ(run->frames, 2500u);
  EXPECT_EQ(run->failed_writes, 0u);
  ASSERT_EQ(recorder.now_s.size(), 2500u);
  EXPECT_EQ(recorder.now_s[0], 0.0);
  EXPECT_EQ(recorder.now_s[2499], 2.499);
  EXPECT_EQ(recorder.negative_times, 0);
  EXPECT_EQ(device.writes, 2501);
  EXPECT_TRUE(is_zero(device.last));
  EXPECT_EQ(device.closed, 1);
}

TEST(VirtualLoop, AStopLeadsTheWrenchDown) {
  FakeDevice device;
  PushingFrame frame;
  Recorder recorder;
  recorder.stop_after = 100;
  const Result<VirtualRun> run = run_virtual(device, frame, 1000.0, 1000000, &recorder);
  ASSERT_TRUE(run);
  EXPECT_TRUE(run->stopped_early);
  EXPECT_GE(run->frames, 110u);
  EXPECT_LE(run->frames, 112u);
  EXPECT_TRUE(frame.forces_fell_evenly);
  EXPECT_EQ(frame.force, 0.0);
}

TEST(VirtualLoop, AFrameThatWillNotStopIsCut) {
  FakeDevice device;
  PushingFrame frame;
  frame.stops = false;
  Recorder recorder;
  recorder.stop_after = 10;
  const Result<VirtualRun> run = run_virtual(device, frame, 1000.0, 1000000, &recorder);
  ASSERT_TRUE(run);
  EXPECT_EQ(run->frames, 10u + 500u);
  EXPECT_TRUE(is_zero(device.last));
}

TEST(VirtualLoop, RefusesABadRateAndADeadDevice) {
  FakeDevice device;
  PushingFrame frame;
  EXPECT_FALSE(run_virtual(device, frame, 0.0, 10));
  EXPECT_FALSE(run_virtual(device, frame, std::numeric_limits<double>::quiet_NaN(), 10));
  device.refuses_open = true;
  const Result<VirtualRun> run = run_virtual(device, frame, 1000.0, 10);
  ASSERT_FALSE(run);
  EXPECT_EQ(frame.frames, 0);
}

/// A wall at x = 0 behind the safety stage: the smallest real frame.
class WallFrame final : public HapticFrame {
 public:
  explicit WallFrame(const DeviceInfo& info) : limits_(safety_limits(info)) {}
  Wrench run(const DeviceSample& sample, const FrameTick& tick) noexcept override {
    const double depth = std::max(0.0, sample.X_DH.p.x());
    SafetyInput input;
    input.wanted.f.x() = -500.0 * depth;
    input.X_DH = sample.X_DH;
    input.sample_valid = sample.valid;
    input.sample_age_s = tick.now_s - sample.time_s;
    input.period_s = tick.period_s;
    input.late = tick.late;
    input.stop = tick.stop;
    std::uint32_t flags = 0;
    const Wrench F = safe_wrench(limits_, state_, input, flags);
    sum = sum + F;
    return F;
  }
  Wrench sum;

 private:
  SafetyLimits limits_;
  SafetyState state_;
};

TEST(VirtualLoop, ASimulatedHandIsHeldByAWallTheSameEveryTime) {
  auto motion = std::make_shared<ScriptedMotion>(Pose{Mat3::Identity(), {-0.02, 0, 0}});
  motion->hold(0.6).move_to(0.5, {Mat3::Identity(), {0.02, 0, 0}}).hold(1.5);
  DeviceOptions options;
  options.hand_motion = motion;
  Vec3 sums[2];
  for (Vec3& sum : sums) {
    Result<std::unique_ptr<Device>> device = make_device("simulated:sigma.7", options);
    ASSERT_TRUE(device);
    WallFrame frame((*device)->info());
    ASSERT_TRUE(run_virtual(**device, frame, 1000.0, 2600));
    sum = frame.sum.f;
  }
  EXPECT_EQ(sums[0], sums[1]);
  EXPECT_LT(sums[0].x(), -1000.0);
}

TEST(LoopThread, RunsPublishesAndStopsWithALedDownWrench) {
  FakeDevice device;
  PushingFrame frame;
  LoopThread loop;
  ASSERT_TRUE(loop.start(device, frame, plain_settings()));
  EXPECT_FALSE(loop.start(device, frame, plain_settings())) << "already started";
  EXPECT_GE(loop.privileges().sentences.size(), 3u);
  wait_for_frames(loop, 50);
  std::uint64_t popped = 0;
  FrameTiming timing;
  while (loop.timings().pop(timing)) {
    EXPECT_EQ(timing.index, popped++);
    EXPECT_GE(timing.frame_time_s, 0.0);
    EXPECT_GE(timing.wakeup_latency_s, 0.0) << "never woken before the deadline";
    EXPECT_GE(timing.busy_time_s, timing.frame_time_s);
  }
  EXPECT_GT(popped, 0u);
  loop.stop();
  loop.stop();
  const LoopStatus status = loop.status();
  EXPECT_FALSE(status.running);
  EXPECT_FALSE(status.device_lost);
  EXPECT_EQ(status.frames, static_cast<std::uint64_t>(frame.frames));
  EXPECT_EQ(status.failed_writes, 0u);
  EXPECT_TRUE(frame.forces_fell_evenly);
  EXPECT_EQ(frame.force, 0.0);
  EXPECT_TRUE(is_zero(device.last));
  EXPECT_EQ(device.closed, 1);
  // And again with the same objects.
  ASSERT_TRUE(loop.start(device, frame, plain_settings()));
  wait_for_frames(loop, 5);
  loop.stop();
  EXPECT_EQ(device.opened, 2);
  EXPECT_EQ(device.closed, 2);
}

TEST(LoopThread, SkipsMissedPeriodsAndTellsTheFrameItIsLate) {
  FakeDevice device;
  PushingFrame frame;
  frame.slow_frame = 5;
  frame.slow_for = std::chrono::milliseconds(50);
  LoopThread loop;
  LoopSettings settings = plain_settings();
  settings.late_limit_s = 0.030;
  ASSERT_TRUE(loop.start(device, frame, settings));
  wait_for_frames(loop, 20);
  loop.stop();
  const LoopStatus status = loop.status();
  // Fifty periods passed in frame 5; all but the running one are skipped, and none is caught up: the time
  // between the frame after it and its own start is at least the sleep, and later frames keep to the grid.
  EXPECT_GE(status.missed_deadlines, 49u);
  EXPECT_GE(status.late_frames, 1u);
  EXPECT_EQ(status.late_frames, static_cast<std::uint64_t>(frame.late_frames));
  EXPECT_GE(frame.times[6] - frame.times[5], 0.050);
  FrameTiming timing;
  std::uint64_t slots = 0;
  double last_grid_s = 0.0;
  while (loop.timings().pop(timing)) {
    ++slots;
    const double grid_s = timing.now_s - timing.wakeup_latency_s;  // the deadline it woke for
    EXPECT_NEAR(grid_s, 0.001 * static_cast<double>(slots), 1e-8) << "frame " << timing.index;
    EXPECT_GT(grid_s, last_grid_s);
    last_grid_s = grid_s;
    slots += timing.missed_deadlines;
  }
}

TEST(LoopThread, AnUnpluggedDeviceIsGivenUp) {
  FakeDevice device;
  device.writes_before_lost = 20;
  PushingFrame frame;
  LoopThread loop;
  LoopSettings settings = plain_settings();
  settings.writes_until_lost = 10;
  ASSERT_TRUE(loop.start(device, frame, settings));
  while (loop.status().running) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_TRUE(loop.status().device_lost);
  EXPECT_EQ(loop.status().failed_writes, 10u);
  EXPECT_EQ(device.closed, 1);
  loop.stop();
}

TEST(LoopThread, AskingForEverythingSaysWhatWasGot) {
  FakeDevice device;
  PushingFrame frame;
  LoopThread loop;
  LoopSettings settings = plain_settings();
  settings.realtime.realtime = true;
  settings.realtime.lock_memory = true;
  ASSERT_TRUE(loop.start(device, frame, settings));
  wait_for_frames(loop, 10);
  loop.stop();
  for (const std::string& sentence : loop.privileges().sentences) std::printf("  %s\n", sentence.c_str());
  EXPECT_EQ(loop.privileges().sentences.size(), 3u);
}

TEST(LoopThread, ARefusedOpenIsToldAndNothingRuns) {
  FakeDevice device;
  device.refuses_open = true;
  PushingFrame frame;
  LoopThread loop;
  const Result<void> started = loop.start(device, frame, plain_settings());
  ASSERT_FALSE(started);
  EXPECT_NE(started.error().message().find("unplugged"), std::string::npos);
  EXPECT_FALSE(loop.status().running);
  device.refuses_open = false;
  EXPECT_TRUE(loop.start(device, frame, plain_settings()));
}

TEST(LoopThreadDeathTest, AFailedAssertionWritesZeroFirst) {
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  EXPECT_DEATH(
      {
        FakeDevice device;
        device.reports_zero = true;
        PushingFrame frame;
        LoopThread loop;
        if (!loop.start(device, frame, plain_settings())) return;
        wait_for_frames(loop, 5);
        assertion_failed("a mistake of ours", "somewhere.cpp", 1);
      },
      "zero wrench written\n(.|\n)*a mistake of ours");
}

}  // namespace
}  // namespace tactum::loop_test
