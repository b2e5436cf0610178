#pragma once
/// Whether a core works for us alone. Many cores run two threads at once, and on a virtual machine the other
/// one may be anybody's: it comes and goes within milliseconds and takes up to a third of what code gets done
/// that keeps the core busy, while the clock runs on and the operating system reports nothing.

#include "bench/clock.h"

namespace tactum::bench {

class CoreWidth {
 public:
  /// Looks for a second how fast the core can be.
  explicit CoreWidth(const FineClock& clock);
  /// Whether as many instructions that need not wait for each other get through as ever did, to 7 %. Takes
  /// 2 us and touches no memory. On processors other than x86-64 always true.
  bool is_ours() noexcept;

 private:
  double probe_ns() const noexcept;

  const FineClock& clock_;
  double least_ns_;
};

}  // namespace tactum::bench
