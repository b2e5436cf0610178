#pragma once
/// How an impact on the grasped part is felt. An impulse has no duration; shown in a single frame it is a
/// blip that smoothing, the slew limit and the motors swallow [Gregory 2000, 6.2]. Here it is spread over
/// time as a pulse that begins and ends smoothly and has the same momentum,
///
///     F(t) = J a (1 - cos(2 pi t / T)) / T,    0 < t < T,     integral of F = a J
///
/// with the expansion T and the amplification a as settings; T is cut to kMostFrames frames. Pulses of
/// several impacts add up.

#include <array>

#include "tactum/response/settings.h"

namespace tactum::inline v0_1 {

class ImpulseDisplay {
 public:
  static constexpr std::size_t kMostFrames = 1024;  ///< of a pulse

  /// Adds an impulse [N s, N m s] on the hand, at the handle, world axes; `energy_J` is what the bodies lost
  /// by it.
  void add(const Impacts& impacts, double dt_s, const Wrench& impulse, double energy_J) noexcept;
  /// The wrench of all pulses in this frame [N, N m]; the next call is the next frame's.
  Wrench next() noexcept;
  /// The energy of impacts that is still to be felt [J].
  double pending_J() const noexcept { return pending_J_; }

  /// What is carried from frame to frame (carried_state.h).
  template <class Self, class Visit>
  static void carried(Self& self, Visit& visit) noexcept {
    visit(self.ahead_, self.energy_, self.pending_J_, self.now_);
  }

 private:
  std::array<Wrench, kMostFrames> ahead_{};   // a ring
  std::array<double, kMostFrames> energy_{};  // beside it
  double pending_J_ = 0.0;
  std::size_t now_ = 0;
};

}  // namespace tactum::inline v0_1
