#pragma once
/// How much of a test a build runs: TACTUM_FULL=1 asks for the long variants, and a sanitized build, which
/// looks for faults of memory and is many times slower, runs a part of the usual ones.

#include <cstddef>
#include <cstdlib>
#include <string>
#include <vector>

namespace tactum::testing {

#ifdef TACTUM_SANITIZED
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

/// How much of a loop runs: `usual`, or `sanitized` in a sanitized build.
template <class Count>
constexpr Count effort(Count usual, Count sanitized) {
  return kSanitized ? sanitized : usual;
}

/// Every `stride`-th of the variants in a sanitized build, all of them otherwise. A stride that shares no
/// divisor with the counts that the variants are made of takes every value of each at least once.
template <class Variants>
Variants sampled(Variants variants, int stride) {
  if (!kSanitized) return variants;
  Variants some;
  for (std::size_t i = 0; i < variants.size(); i += std::size_t(stride)) some.push_back(variants[i]);
  return some;
}

/// The rates of frames at which a law is tested [Hz]. A sanitized build takes the one that computes a second
/// of motion in the fewest frames.
inline std::vector<double> frame_rates_Hz() {
  if (kSanitized) return {500.0};
  return {500.0, 1000.0, 4000.0};
}

/// Whether the long variants of tests run.
inline bool full_run() {
  const char* const full = std::getenv("TACTUM_FULL");
  return full != nullptr && std::string(full) != "0";
}

}  // namespace tactum::testing
