#pragma once
/// A clock for tens of nanoseconds. The processor's own counter, fenced so that nothing timed leaks out of
/// the interval, and calibrated against steady_clock; where there is no invariant counter, steady_clock
/// itself.

#include <cstdint>
#include <string>

namespace tactum::bench {

class FineClock {
 public:
  FineClock();  ///< calibrates for 50 ms

  std::uint64_t start() const noexcept;
  std::uint64_t stop() const noexcept;
  double ns(std::uint64_t ticks) const noexcept { return static_cast<double>(ticks) * ns_per_tick_; }
  /// The step it advances by: on some machines many ticks.
  double step_ns() const noexcept { return ns(step_); }
  /// "the processor's counter (0.38 ns a tick, in steps of 10 ns)", or steady_clock and its steps.
  std::string describe() const;

 private:
  bool counter_ = false;
  double ns_per_tick_ = 1.0;  ///< [ns]
  std::uint64_t step_ = 1;    ///< the least by which intervals differ [ticks]
};

}  // namespace tactum::bench
