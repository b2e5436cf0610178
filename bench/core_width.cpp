#include "bench/core_width.h"

#include <algorithm>
#include <vector>

namespace tactum::bench {

#if defined(__x86_64__)

namespace {

/// Additions and multiplications in ten chains, six and more a cycle.
void work() noexcept {
  constexpr int kRounds = 2000;
  long a = 0, b = 0, c = 0, d = 0;
  double s = 1.0, t = 1.0, u = 1.0, v = 1.0, w = 1.0, x = 1.0;
  const auto add = [&] {
    a += 1, b += 1, c += 1, d += 1;
    // Keeps the compiler from leaving out, joining or precomputing the operations.
    asm volatile("" : "+r"(a), "+r"(b), "+r"(c), "+r"(d));
  };
  for (int i = 0; i < kRounds; ++i) {
    add(), add(), add();
    s *= s, t *= t, u *= u, v *= v, w *= w, x *= x;
    asm volatile("" : "+x"(s), "+x"(t), "+x"(u), "+x"(v), "+x"(w), "+x"(x));
  }
}

}  // namespace

CoreWidth::CoreWidth() {
  constexpr double kLook_ns = 1e9;
  std::vector<double> probes;
  const std::uint64_t start = clock_.start();
  do {
    probes.push_back(probe_ns());
  } while (clock_.ns(clock_.stop() - start) < kLook_ns);
  // Not the least, which may be a reading gone wrong.
  const auto low = probes.begin() + static_cast<std::ptrdiff_t>(probes.size() / 100);
  std::nth_element(probes.begin(), low, probes.end());
  alone_ns_ = *low;
}

double CoreWidth::probe_ns() const noexcept {
  const std::uint64_t start = clock_.start();
  work();
  return clock_.ns(clock_.stop() - start);
}

bool CoreWidth::is_ours() noexcept {
  constexpr double kSame = 1.07;
  constexpr double kHaste = 0.01;  // a faster time is accepted when it is seen again and again
  const double ns = probe_ns();
  alone_ns_ += kHaste * std::min(0.0, ns - alone_ns_);
  return ns <= kSame * alone_ns_ + clock_.step_ns();
}

#else

CoreWidth::CoreWidth() = default;
double CoreWidth::probe_ns() const noexcept { return 0.0; }
bool CoreWidth::is_ours() noexcept { return true; }

#endif

}  // namespace tactum::bench
