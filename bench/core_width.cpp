#include "bench/core_width.h"

#include <algorithm>
#include <limits>

namespace tactum::bench {
namespace {

#if defined(__x86_64__)
/// Additions and multiplications in many chains, as wide as the widest cores.
void work() noexcept {
  constexpr int kRounds = 2000;
  long a = 0, b = 0, c = 0, d = 0;
  double s = 1.0, t = 1.0, u = 1.0, v = 1.0, w = 1.0, x = 1.0;
  for (int i = 0; i < kRounds; ++i) {
    for (int k = 0; k < 3; ++k) {
      a += 1, b += 1, c += 1, d += 1;
      // Nothing of it is left out, put together or told beforehand.
      asm volatile("" : "+r"(a), "+r"(b), "+r"(c), "+r"(d));
    }
    s *= s, t *= t, u *= u, v *= v, w *= w, x *= x;
    asm volatile("" : "+x"(s), "+x"(t), "+x"(u), "+x"(v), "+x"(w), "+x"(x));
  }
}
#else
void work() noexcept {}
#endif

}  // namespace

CoreWidth::CoreWidth(const FineClock& clock) : clock_(clock), least_ns_(std::numeric_limits<double>::max()) {
  constexpr double kLook_ns = 1e9;
  const std::uint64_t start = clock_.start();
  do {
    least_ns_ = std::min(least_ns_, probe_ns());
  } while (clock_.ns(clock_.stop() - start) < kLook_ns);
}

double CoreWidth::probe_ns() const noexcept {
  const std::uint64_t start = clock_.start();
  work();
  return clock_.ns(clock_.stop() - start);
}

bool CoreWidth::is_ours() noexcept {
  constexpr double kSame = 1.07;
  const double ns = probe_ns();
  least_ns_ = std::min(least_ns_, ns);
  return ns <= kSame * least_ns_ + clock_.step_ns();
}

}  // namespace tactum::bench
