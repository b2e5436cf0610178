#include "tactum/loop/machine.h"

#include <fmt/format.h>
#include <sched.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <thread>

#include "tactum/loop/loop_thread.h"

namespace tactum::inline v0_1 {
namespace {

constexpr double kInTime = 0.25;  // of a period: a wake-up or a device that takes more leaves too little
constexpr const char* kLimitsCure =
    "Allow it: sudo tactum doctor --install-limits, join the group plugdev (sudo adduser $USER plugdev), and "
    "log in anew.";

/// The first line of a file; empty when it cannot be read.
std::string line_of(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line;
}

MachineFinding realtime_right(const LoopPrivileges& got) {
  if (got.realtime) return {"real-time scheduling", Verdict::kGood, "granted (SCHED_FIFO)", ""};
  return {"real-time scheduling", Verdict::kBetter, "refused: other programs can delay frames", kLimitsCure};
}

MachineFinding memory_right(const LoopPrivileges& got) {
  if (got.memory_locked) return {"memory lock", Verdict::kGood, "granted", ""};
  return {"memory lock", Verdict::kBetter, "refused: a frame can wait for a page from disk", kLimitsCure};
}

/// The loop takes one core, what people see another.
MachineFinding cores_of_process() {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  const int cores = sched_getaffinity(0, sizeof allowed, &allowed) == 0 ? CPU_COUNT(&allowed) : 1;
  const std::string found = fmt::format("{} for this process", cores);
  if (cores >= 2) return {"cores", Verdict::kGood, found, ""};
  return {"cores", Verdict::kBad, found,
          "The loop needs one and the page another: run without --view, or on a machine with two cores."};
}

MachineFinding clock_source(const std::string& root) {
  const std::string source =
      line_of(root + "/sys/devices/system/clocksource/clocksource0/current_clocksource");
  if (source.empty()) return {"clock", Verdict::kGood, "not told by the kernel", ""};
  if (source != "hpet" && source != "acpi_pm") return {"clock", Verdict::kGood, source, ""};
  return {"clock", Verdict::kBetter, source + ": every reading of it takes a microsecond or more",
          "Start the kernel with clocksource=tsc, if it holds the processor's own clock for sound."};
}

/// Power saving lowers the frequency of a core that sleeps most of each millisecond.
MachineFinding power_saving(const std::string& root) {
  const std::string folder = root + "/sys/devices/system/cpu";
  int saving = 0, known = 0;
  std::error_code none;
  for (const std::filesystem::directory_entry& entry : std::filesystem::directory_iterator(folder, none)) {
    const std::string governor = line_of(entry.path().string() + "/cpufreq/scaling_governor");
    if (governor.empty()) continue;
    ++known;
    if (governor != "performance") ++saving;
  }
  if (known == 0) return {"power saving", Verdict::kGood, "the kernel does not set the frequency", ""};
  if (saving == 0) return {"power saving", Verdict::kGood, "off on every core", ""};
  return {"power saving", Verdict::kBetter, fmt::format("on for {} of {} cores", saving, known),
          "Switch it off while you feel: sudo cpupower frequency-set --governor performance."};
}

/// A frame that takes all of its period would be stopped when the share is used up.
MachineFinding realtime_share(const std::string& root) {
  const std::string folder = root + "/proc/sys/kernel/sched_rt_";
  const double runtime_us = std::atof(line_of(folder + "runtime_us").c_str());
  const double period_us = std::atof(line_of(folder + "period_us").c_str());
  if (!(period_us > 0.0)) return {"share of real-time threads", Verdict::kGood, "not told by the kernel", ""};
  const double share = runtime_us < 0.0 ? 1.0 : runtime_us / period_us;
  const std::string found = fmt::format("{:.0f} % of a core", 100.0 * share);
  if (share >= 0.9) return {"share of real-time threads", Verdict::kGood, found, ""};
  return {"share of real-time threads", Verdict::kBetter, found,
          "Give them the usual share: sudo sysctl kernel.sched_rt_runtime_us=950000."};
}

/// Takes every wrench and has no handle.
class NoDevice final : public Device {
 public:
  Result<void> open() override { return {}; }
  void close() noexcept override {}
  const DeviceInfo& info() const noexcept override { return info_; }
  bool read(double now_s, DeviceSample& sample) noexcept override {
    sample.time_s = now_s;
    sample.valid = true;
    return true;
  }
  bool write(const Wrench& /*F_D*/) noexcept override { return true; }

 private:
  DeviceInfo info_{.name = "none"};
};

/// Exerts nothing, and counts what comes from the device.
class Listening final : public HapticFrame {
 public:
  Wrench run(const DeviceSample& sample, const FrameTick& /*tick*/) noexcept override {
    const bool same = sample.X_DH.p == last_.X_DH.p && sample.X_DH.R == last_.X_DH.R &&
                      sample.V_DH.v == last_.V_DH.v && sample.V_DH.w == last_.V_DH.w;
    if (sample.valid && !same) ++new_poses_;
    last_ = sample;
    return {};
  }
  std::uint64_t new_poses() const noexcept { return new_poses_; }

 private:
  DeviceSample last_;
  std::uint64_t new_poses_ = 0;
};

double median(std::vector<double>& values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double most(const std::vector<double>& values) {
  return values.empty() ? 0.0 : *std::max_element(values.begin(), values.end());
}

std::string microseconds(double time_s) { return fmt::format("{:.0f} us", 1e6 * time_s); }

}  // namespace

std::vector<MachineFinding> examine_machine(const std::string& root) {
  LoopPrivileges got;
  std::thread([&got] { got = acquire_privileges({}); }).join();  // they are those of the thread that asks
  return {realtime_right(got), memory_right(got),  cores_of_process(),
          clock_source(root),  power_saving(root), realtime_share(root)};
}

Result<LoopMeasure> measure_loop(Device& device, double rate_Hz, double duration_s) {
  Listening frame;
  LoopThread loop;
  const auto frames = static_cast<std::uint64_t>(rate_Hz * duration_s);
  LoopSettings settings;
  settings.rate_Hz = rate_Hz;
  settings.frames = frames;
  settings.timing_room = frames + 1;
  if (Result<void> started = loop.start(device, frame, settings); !started) return started.error();
  while (loop.status().running) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  loop.stop();
  std::vector<double> wake_ups, transfers;
  for (FrameTiming timing; loop.timings().pop(timing);) {
    wake_ups.push_back(timing.wakeup_latency_s);
    transfers.push_back(timing.busy_time_s - timing.frame_time_s);
  }
  const LoopStatus status = loop.status();
  LoopMeasure measure;
  measure.wake_up_most_s = most(wake_ups);
  measure.wake_up_median_s = median(wake_ups);
  measure.device_most_s = most(transfers);
  measure.device_median_s = median(transfers);
  measure.frames = status.frames;
  measure.missed = status.missed_deadlines;
  measure.failed_reads = status.failed_reads;
  measure.refused = status.failed_writes;
  measure.new_poses = frame.new_poses();
  return measure;
}

LoopMeasure measure_wake_ups(double rate_Hz, double duration_s) {
  NoDevice none;
  Result<LoopMeasure> measure = measure_loop(none, rate_Hz, duration_s);
  return measure ? *measure : LoopMeasure{};
}

MachineFinding judge_wake_ups(const LoopMeasure& measure, double rate_Hz) {
  const std::string found =
      fmt::format("{} late in the median, {} at most, {} of {} frames missed, at {:.0f} Hz",
                  microseconds(measure.wake_up_median_s), microseconds(measure.wake_up_most_s),
                  measure.missed, measure.frames, rate_Hz);
  const double in_time_s = kInTime / rate_Hz;
  if (measure.frames > 0 && measure.wake_up_most_s <= in_time_s)
    return {"wake-ups", Verdict::kGood, found, ""};
  const bool always = measure.frames == 0 || measure.wake_up_median_s > in_time_s;
  return {
      "wake-ups", always ? Verdict::kBad : Verdict::kBetter, found,
      "Close other programs, take the cures above, and, where seldom late is too often, a kernel for real "
      "time (Debian: linux-image-rt-amd64)."};
}

MachineFinding judge_device(const LoopMeasure& measure, const DeviceInfo& device, double rate_Hz) {
  std::string found = fmt::format("read and write take {} in the median, {} at most",
                                  microseconds(measure.device_median_s), microseconds(measure.device_most_s));
  found += fmt::format("; {} of {} reads failed, {} writes were refused; it gave a new pose {} times",
                       measure.failed_reads, measure.frames, measure.refused, measure.new_poses);
  if (measure.failed_reads > 0 || measure.refused > 0)
    return {device.name, Verdict::kBad, found,
            "Look at the cable, plug the device into the machine itself instead of a hub, and close other "
            "programs that use it."};
  if (measure.device_median_s > kInTime / rate_Hz)
    return {device.name, Verdict::kBad, found,
            fmt::format("It is too slow for {:.0f} Hz: give the scene a dt_s of {:.2g} or more.", rate_Hz,
                        measure.device_median_s / kInTime)};
  if (measure.device_most_s > kInTime / rate_Hz)
    return {device.name, Verdict::kBetter, found,
            "Plug it into the machine itself instead of a hub, away from cameras and disks."};
  return {device.name, Verdict::kGood, found, ""};
}

const char* realtime_limits() {
  return R"(# Haptic loops: members of the group plugdev may run threads in real time and lock their memory.
@plugdev - rtprio 90
@plugdev - memlock unlimited
)";
}

}  // namespace tactum::inline v0_1
