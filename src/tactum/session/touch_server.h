#pragma once
/// Serves a device step by step for the guided first touch (first_touch.h): reads, writes, and lets every
/// wrench pass the safety stage (loop/safety.h), which each step begins anew, with a ramp from zero.
///
///   step ----> wanted --> safe_wrench --> write        done, time over, the person stops: led to zero
///    ^                                                 fault: zero at once, and the step ends
///    +-------- sample <-- read                         lost: refused or unread for too long

#include <cstdint>
#include <functional>
#include <optional>

#include "tactum/loop/safety.h"

namespace tactum::inline v0_1 {

/// The time of the guide, so that it can be run on a virtual clock.
class TouchClock {
 public:
  virtual ~TouchClock() = default;
  /// On a clock that never goes back [s].
  virtual double now_s() noexcept = 0;
  /// Returns at that time, or at once where it is over [s].
  virtual void wait_until(double time_s) noexcept = 0;

 protected:
  TouchClock() = default;
  TouchClock(const TouchClock&) = default;
  TouchClock& operator=(const TouchClock&) = default;
};

/// The monotonic clock of the machine.
class SteadyTouchClock final : public TouchClock {
 public:
  double now_s() noexcept override;
  void wait_until(double time_s) noexcept override;
};

/// Why a step is over.
enum class StepEnd {
  kDone,      ///< the step says so
  kTimeOver,  ///< it did not within its time
  kStopped,   ///< the person does not want to go on
  kFault,     ///< safety found a fault: StepResult::faults
  kLost       ///< the device took no wrench, or gave no sample, for long
};

struct StepResult {
  StepEnd end = StepEnd::kDone;
  std::uint32_t faults = 0;  ///< safety_flag of what ended the step
  double largest_N = 0.0;    ///< of the forces that were sent [N]
  double largest_Nm = 0.0;   ///< of the torques [N m]
};

/// What a step sees in a frame.
struct TouchFrame {
  const DeviceSample& sample;  ///< the newest; its pose is the last known where it is not valid
  const Wrench& sent;          ///< what was sent in the last frame [N, N m]
  double now_s = 0.0;          ///< on the clock [s]
  double since_s = 0.0;        ///< the step's beginning [s]
};

/// The wrench that a step wants; nothing when it is done.
using TouchStep = std::function<std::optional<Wrench>(const TouchFrame&)>;

class TouchServer {
 public:
  /// `stopped` is asked in every frame whether the person wants to stop. All must outlive the server; the
  /// device is open.
  TouchServer(Device& device, TouchClock& clock, double rate_Hz, std::function<bool()> stopped);

  /// Serves until the step ends and the wrench is zero. With `quiet` a fault ends nothing, as the step sends
  /// zero anyhow.
  StepResult serve(const SafetyLimits& limits, double at_most_s, const TouchStep& step, bool quiet = false);

  double period_s() const noexcept { return period_s_; }

 private:
  bool send(const Wrench& F, StepResult& result) noexcept;

  Device& device_;
  TouchClock& clock_;
  double period_s_;
  std::function<bool()> stopped_;
  DeviceSample sample_;
  double start_s_ = 0.0;  // of the device's clock, on ours
  bool started_ = false;
  int refused_in_a_row_ = 0;
  double unread_since_s_ = 0.0;  // since the device's start
};

}  // namespace tactum::inline v0_1
