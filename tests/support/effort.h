#pragma once
/// How much of a test a build runs: TACTUM_FULL=1 asks for the long variants, and a sanitized build, which
/// looks for faults of memory and is many times slower, runs a part of the usual ones.

#include <cstdlib>
#include <string>

namespace tactum::testing {

#ifdef TACTUM_SANITIZED
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

/// Whether the long variants of tests run.
inline bool full_run() {
  const char* const full = std::getenv("TACTUM_FULL");
  return full != nullptr && std::string(full) != "0";
}

}  // namespace tactum::testing
