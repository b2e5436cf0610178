#include "bench/clock.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <vector>

#if defined(__x86_64__)
#include <cpuid.h>
#include <x86intrin.h>
#endif

namespace tactum::bench {
namespace {

std::uint64_t steady_ns() {
  return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(
                                        std::chrono::steady_clock::now().time_since_epoch())
                                        .count());
}

#if defined(__x86_64__)
/// Does the counter tick at one rate, whatever the processor's clock does?
bool invariant_counter() {
  unsigned a = 0;
  unsigned b = 0;
  unsigned c = 0;
  unsigned d = 0;
  constexpr unsigned kPowerLeaf = 0x80000007u;
  return __get_cpuid(kPowerLeaf, &a, &b, &c, &d) != 0 && (d & (1u << 8)) != 0;
}

std::uint64_t counter_start() {
  _mm_lfence();
  const std::uint64_t ticks = __rdtsc();
  _mm_lfence();
  return ticks;
}

std::uint64_t counter_stop() {
  unsigned core = 0;
  const std::uint64_t ticks = __rdtscp(&core);
  _mm_lfence();
  return ticks;
}
#else
bool invariant_counter() { return false; }
std::uint64_t counter_start() { return 0; }
std::uint64_t counter_stop() { return 0; }
#endif

}  // namespace

FineClock::FineClock() : counter_(invariant_counter()) {
  if (counter_) {
    constexpr std::uint64_t kCalibration_ns = 50'000'000;
    const std::uint64_t begin_ns = steady_ns();
    const std::uint64_t begin = counter_start();
    std::uint64_t end_ns = begin_ns;
    while (end_ns - begin_ns < kCalibration_ns) end_ns = steady_ns();
    ns_per_tick_ = static_cast<double>(end_ns - begin_ns) / static_cast<double>(counter_stop() - begin);
  }
  // Intervals of many lengths differ by a step at least.
  std::vector<std::uint64_t> lengths;
  volatile int work = 0;
  for (int i = 0; i < 10000; ++i) {
    const std::uint64_t before = start();
    for (int k = 0; k < i % 64; ++k) work = work + 1;
    lengths.push_back(stop() - before);
  }
  std::sort(lengths.begin(), lengths.end());
  std::uint64_t least = std::numeric_limits<std::uint64_t>::max();
  for (std::size_t i = 1; i < lengths.size(); ++i)
    if (lengths[i] > lengths[i - 1]) least = std::min(least, lengths[i] - lengths[i - 1]);
  if (least < std::numeric_limits<std::uint64_t>::max()) step_ = least;
}

std::uint64_t FineClock::start() const noexcept { return counter_ ? counter_start() : steady_ns(); }
std::uint64_t FineClock::stop() const noexcept { return counter_ ? counter_stop() : steady_ns(); }

std::string FineClock::describe() const {
  return counter_ ? fmt::format("the processor's counter ({:.2f} ns a tick, in steps of {:.1f} ns)",
                                ns_per_tick_, step_ns())
                  : fmt::format("steady_clock (in steps of {:.1f} ns)", step_ns());
}

}  // namespace tactum::bench
