#pragma once
/// What every driver does with a wrench, whatever the stages before it did (loop/safety.h):
///
///   CommandGate    a wrench that is not finite is refused, one beyond the device's limits is shortened
///   StaleClock     tells whether the writer has fallen silent, to a library that calls the driver regularly
///   StaleGuard     the same for a library that does not: sends zero from a thread of its own, again and
///                  again, while the writer is silent
///
/// The first write after a silence is refused, so that the loop's safety stage begins its start ramp anew:
///
///   write ----*--*--*--*                      *  refused, zero      *  taken, from zero on
///   guard                 stale_after_s: 0 0 0
///
/// The guard is for a loop that hangs or has ended in a living process. Against a process that ends or stands
/// still only the device's own watchdog helps; drivers set it where there is one.

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <thread>

#include "tactum/base/result.h"
#include "tactum/devices/device.h"

namespace tactum::inline v0_1 {

/// Longer than the loop's own limit for a late frame (a period and 10 ms), so that the loop notices first,
/// and shorter than the 20 ms within which a device is to be at rest [s].
inline constexpr double kStaleAfter_s = 0.015;

class CommandGate {
 public:
  CommandGate() = default;
  /// A device without force or torque has a limit of zero.
  explicit CommandGate(const DeviceInfo& info)
      : max_force_N_(info.actuates_force ? info.max_force_N : 0.0),
        max_torque_Nm_(info.actuates_torque ? info.max_torque_Nm : 0.0) {}

  /// The wrench that may be sent; false, and zero, for one that is not finite. What is within the limits
  /// passes unchanged to the bit.
  bool pass(const Wrench& wanted, Wrench& sent) const noexcept;

 private:
  double max_force_N_ = 0.0;
  double max_torque_Nm_ = 0.0;
};

class StaleClock {
 public:
  void start(double stale_after_s) noexcept;
  /// The writer is about to write; false when it had been silent for too long: it must then send zero and
  /// report that it did. No lock.
  bool on_time() noexcept;
  /// Whether the writer is silent for too long; whoever asks must send zero then. From another thread.
  bool stale() noexcept;

 private:
  std::int64_t stale_after_ns_ = 0;
  std::atomic<std::int64_t> written_ns_{0};
  std::atomic<bool> acted_{false};
};

class StaleGuard {
 public:
  StaleGuard() = default;
  ~StaleGuard() { stop(); }
  StaleGuard(const StaleGuard&) = delete;
  StaleGuard& operator=(const StaleGuard&) = delete;

  /// Starts the thread. `send_zero` is called on it, at the same time as other calls of the driver, and must
  /// not throw.
  Result<void> start(double stale_after_s, std::function<void()> send_zero);
  /// Ends the thread. Safe to call twice.
  void stop() noexcept;

  /// As of the clock.
  bool on_time() noexcept { return clock_.on_time(); }

 private:
  void watch(std::chrono::nanoseconds look_every) noexcept;

  StaleClock clock_;
  std::function<void()> send_zero_;
  std::mutex mutex_;
  std::condition_variable stopped_;
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace tactum::inline v0_1
