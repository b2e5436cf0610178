#pragma once
/// Whether a core works for us alone. Many cores run two threads at once, and on a virtual machine the other
/// one may belong to anyone: it comes and goes within milliseconds and takes up to a third of the throughput
/// of code that keeps the core busy, while the clock runs on and the operating system reports nothing.

#include "bench/clock.h"

namespace tactum::bench {

class CoreWidth {
 public:
  /// Measures for a second how fast the core can be.
  CoreWidth();
  /// Whether as many instructions that need not wait for each other complete as ever did, to 7 %: no other
  /// thread's are in between. A thread that waits for memory meanwhile, or fills caches, is not noticed.
  /// Takes 2 us and touches no memory. On processors other than x86-64 always true.
  bool is_ours() noexcept;

 private:
  double probe_ns() const noexcept;

  FineClock clock_;
  double alone_ns_ = 0.0;  ///< the time of the probe on a core of our own [ns]
};

}  // namespace tactum::bench
