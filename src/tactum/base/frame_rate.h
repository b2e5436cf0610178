#pragma once
/// Behaviour is stated in seconds; a frame needs it in steps of its own length.

#include <algorithm>
#include <cmath>

namespace tactum::inline v0_1 {

/// The step for which limits per frame are stated [s].
inline constexpr double kReferenceStep_s = 0.001;

/// How many frames of `dt_s` make up a time, rounded; at least one.
inline int frames_in(double time_s, double dt_s) noexcept {
  return std::max(1, static_cast<int>(std::lround(time_s / dt_s)));
}

}  // namespace tactum::inline v0_1
