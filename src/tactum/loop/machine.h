#pragma once
/// What decides on a machine whether the loop's thread wakes on time and its device answers in time: asked of
/// the operating system, then measured. For `tactum doctor`; all of it is slow and allocates.

#include <string>
#include <vector>

#include "tactum/base/result.h"
#include "tactum/devices/device.h"

namespace tactum::inline v0_1 {

enum class Verdict {
  kGood,
  kBetter,  ///< frames may be late now and then: it could be better
  kBad      ///< the loop cannot run on time
};

/// One answer about the machine.
struct MachineFinding {
  std::string subject;               ///< "cores"
  Verdict verdict = Verdict::kGood;  ///< whether it stands in the way
  std::string found;                 ///< what was found, in words
  std::string cure;                  ///< a sentence that says what helps; empty for Verdict::kGood
};

/// Rights of this process, cores, clock, power saving and the kernel's share for real-time threads. `root`
/// is put before the paths of the system's files.
std::vector<MachineFinding> examine_machine(const std::string& root = "");

/// How late threads woke, and how long a device took.
struct LoopMeasure {
  double wake_up_median_s = 0.0;   ///< begun after the deadline by [s]
  double wake_up_most_s = 0.0;     ///< the latest of all [s]
  double device_median_s = 0.0;    ///< of a read and a write [s]
  double device_most_s = 0.0;      ///< the longest of all [s]
  std::uint64_t frames = 0;        ///< measured
  std::uint64_t missed = 0;        ///< deadlines that passed while a frame ran
  std::uint64_t failed_reads = 0;  ///< samples that were not valid
  std::uint64_t refused = 0;       ///< writes the device did not take
  std::uint64_t new_poses = 0;     ///< samples whose pose or velocity was not that of the last
};

/// Runs the loop at `rate_Hz` for `duration_s` with zero wrench on `device`, which is opened and closed. An
/// error when it cannot be opened.
Result<LoopMeasure> measure_loop(Device& device, double rate_Hz, double duration_s);
/// The same with no device at all.
LoopMeasure measure_wake_ups(double rate_Hz, double duration_s);

/// Whether frames at `rate_Hz` begin on time: late by at most a quarter of a period.
MachineFinding judge_wake_ups(const LoopMeasure& measure, double rate_Hz);
/// Whether `device` answers in time: a read and a write take at most a quarter of a period, none fails.
MachineFinding judge_device(const LoopMeasure& measure, const DeviceInfo& device, double rate_Hz);

/// Where the limits belong that let users' threads run in real time and lock their memory.
inline constexpr const char* kLimitsPath = "/etc/security/limits.d/71-tactum-realtime.conf";
/// The text of that file. The group is that of the rules for devices (drivers/udev_rules.h).
const char* realtime_limits();

}  // namespace tactum::inline v0_1
