#include "tactum/response/impulse_display.h"

#include <algorithm>
#include <cmath>

namespace tactum::inline v0_1 {

void ImpulseDisplay::add(const Impacts& impacts, double dt_s, const Wrench& impulse,
                         double energy_J) noexcept {
  const double frames = std::clamp(std::round(impacts.expansion_s / dt_s), 1.0, double(kMostFrames));
  const auto count = static_cast<std::size_t>(frames);
  const Wrench mean = impulse * (impacts.amplification / (frames * dt_s));
  for (std::size_t k = 0; k < count; ++k) {
    // Taken at the middle of each frame, these add up to `frames` exactly.
    const double weight =
        count == 1 ? 1.0 : 1.0 - std::cos(2.0 * kPi * (static_cast<double>(k) + 0.5) / frames);
    Wrench& felt = ahead_[(now_ + k) % kMostFrames];
    felt = felt + mean * weight;
    energy_[(now_ + k) % kMostFrames] += energy_J * weight / frames;
  }
  pending_J_ += energy_J;
}

Wrench ImpulseDisplay::next() noexcept {
  const Wrench felt = ahead_[now_];
  ahead_[now_] = {};
  pending_J_ = std::max(0.0, pending_J_ - energy_[now_]);
  energy_[now_] = 0.0;
  now_ = (now_ + 1) % kMostFrames;
  return felt;
}

}  // namespace tactum::inline v0_1
