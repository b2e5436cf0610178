#include "tactum/loop/machine.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "app/program.h"

namespace tactum {
namespace {

using testing::ScratchFolder;

/// A system's files as they would stand under another root.
void put(const ScratchFolder& root, const std::string& path, const std::string& text) {
  const std::filesystem::path file(root / path);
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file) << text << "\n";
}

MachineFinding finding_of(const ScratchFolder& root, const std::string& subject) {
  for (const MachineFinding& finding : examine_machine(root / ""))
    if (finding.subject == subject) return finding;
  ADD_FAILURE() << "nothing is said of " << subject;
  return {};
}

constexpr const char* kClock = "sys/devices/system/clocksource/clocksource0/current_clocksource";

TEST(Machine, ASlowClockHasItsCureAndAGoodOneNone) {
  const ScratchFolder root;
  put(root, kClock, "tsc");
  EXPECT_EQ(finding_of(root, "clock").verdict, Verdict::kGood);
  EXPECT_EQ(finding_of(root, "clock").found, "tsc");
  for (const char* slow : {"hpet", "acpi_pm"}) {
    put(root, kClock, slow);
    const MachineFinding finding = finding_of(root, "clock");
    EXPECT_EQ(finding.verdict, Verdict::kBetter) << slow;
    EXPECT_NE(finding.found.find(slow), std::string::npos);
    EXPECT_NE(finding.cure.find("clocksource=tsc"), std::string::npos);
  }
}

TEST(Machine, PowerSavingIsCountedByCore) {
  const ScratchFolder root;
  EXPECT_EQ(finding_of(root, "power saving").verdict, Verdict::kGood);  // nothing is known of it
  for (int core = 0; core < 3; ++core)
    put(root, "sys/devices/system/cpu/cpu" + std::to_string(core) + "/cpufreq/scaling_governor",
        core == 1 ? "performance" : "powersave");
  const MachineFinding finding = finding_of(root, "power saving");
  EXPECT_EQ(finding.verdict, Verdict::kBetter);
  EXPECT_EQ(finding.found, "on for 2 of 3 cores");
  EXPECT_NE(finding.cure.find("cpupower"), std::string::npos);
}

TEST(Machine, TheShareOfRealTimeThreadsIsThatOfTheKernel) {
  const ScratchFolder root;
  put(root, "proc/sys/kernel/sched_rt_period_us", "1000000");
  const std::pair<const char*, Verdict> cases[] = {{"950000", Verdict::kGood},
                                                   {"-1", Verdict::kGood},
                                                   {"400000", Verdict::kBetter},
                                                   {"0", Verdict::kBetter}};
  for (const auto& [runtime, verdict] : cases) {
    put(root, "proc/sys/kernel/sched_rt_runtime_us", runtime);
    const MachineFinding finding = finding_of(root, "share of real-time threads");
    EXPECT_EQ(finding.verdict, verdict) << runtime;
    EXPECT_EQ(finding.cure.empty(), verdict == Verdict::kGood) << runtime;
  }
}

TEST(Machine, WhatIsRefusedIsCuredByTheLimits) {
  for (const MachineFinding& finding : examine_machine()) {
    EXPECT_EQ(finding.cure.empty(), finding.verdict == Verdict::kGood) << finding.subject;
    EXPECT_FALSE(finding.found.empty()) << finding.subject;
  }
  const std::string limits = realtime_limits();
  EXPECT_NE(limits.find("@plugdev - rtprio"), std::string::npos);
  EXPECT_NE(limits.find("@plugdev - memlock unlimited"), std::string::npos);
}

TEST(Machine, WakeUpsAreJudgedByTheirLatestAndTheirMedian) {
  LoopMeasure measure;
  measure.frames = 1000;
  measure.wake_up_median_s = 5e-6;
  measure.wake_up_most_s = 240e-6;
  EXPECT_EQ(judge_wake_ups(measure, 1000.0).verdict, Verdict::kGood);
  EXPECT_EQ(judge_wake_ups(measure, 4000.0).verdict, Verdict::kBetter);  // a quarter of 250 us is 62
  measure.wake_up_most_s = 260e-6;
  EXPECT_EQ(judge_wake_ups(measure, 1000.0).verdict, Verdict::kBetter);
  measure.wake_up_median_s = 251e-6;
  EXPECT_EQ(judge_wake_ups(measure, 1000.0).verdict, Verdict::kBad);
  EXPECT_EQ(judge_wake_ups({}, 1000.0).verdict, Verdict::kBad);  // nothing ran
}

/// Fails every fifth read, refuses every seventh write, and moves every second time it is read.
class Faulty final : public Device {
 public:
  Result<void> open() override {
    ++opened;
    return {};
  }
  void close() noexcept override { ++closed; }
  const DeviceInfo& info() const noexcept override { return info_; }
  bool read(double now_s, DeviceSample& sample) noexcept override {
    sample.time_s = now_s;
    sample.valid = ++reads_ % 5 != 0;
    if (reads_ % 2 == 0) sample.X_DH.p.x() = 1e-4 * reads_;
    return sample.valid;
  }
  bool write(const Wrench& F_D) noexcept override {
    pushed = pushed || !F_D.f.isZero(0.0) || !F_D.t.isZero(0.0);
    return ++writes_ % 7 != 0;
  }
  int opened = 0, closed = 0;
  bool pushed = false;

 private:
  DeviceInfo info_{.name = "faulty"};
  int reads_ = 0, writes_ = 0;
};

TEST(Machine, ADeviceIsMeasuredWithoutAWrench) {
  Faulty device;
  const Result<LoopMeasure> measure = measure_loop(device, 1000.0, 0.1);
  ASSERT_TRUE(measure) << measure.error().message();
  EXPECT_EQ(device.opened, 1);
  EXPECT_EQ(device.closed, 1);
  EXPECT_FALSE(device.pushed);
  EXPECT_GE(measure->frames, 100u);
  EXPECT_EQ(measure->failed_reads, measure->frames / 5);
  EXPECT_GE(measure->refused, measure->frames / 7);
  EXPECT_GE(measure->new_poses, measure->frames / 2 - measure->frames / 5);
  EXPECT_LE(measure->new_poses, measure->frames / 2);
  const MachineFinding finding = judge_device(*measure, device.info(), 1000.0);
  EXPECT_EQ(finding.verdict, Verdict::kBad);
  EXPECT_EQ(finding.subject, "faulty");
  EXPECT_NE(finding.cure.find("cable"), std::string::npos);
}

TEST(Machine, ASlowDeviceIsToldTheStepItCanDo) {
  LoopMeasure measure;
  measure.frames = 1000;
  measure.device_median_s = 0.001;
  measure.device_most_s = 0.0012;
  DeviceInfo info;
  info.name = "slow";
  const MachineFinding slow = judge_device(measure, info, 1000.0);
  EXPECT_EQ(slow.verdict, Verdict::kBad);
  EXPECT_NE(slow.cure.find("dt_s of 0.004"), std::string::npos) << slow.cure;
  measure.device_median_s = 100e-6;
  EXPECT_EQ(judge_device(measure, info, 1000.0).verdict, Verdict::kBetter);
  measure.device_most_s = 200e-6;
  EXPECT_EQ(judge_device(measure, info, 1000.0).verdict, Verdict::kGood);
}

}  // namespace
}  // namespace tactum
