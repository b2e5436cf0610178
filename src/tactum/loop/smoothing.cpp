#include "tactum/loop/smoothing.h"

namespace tactum {

Vec3 smoothed(const Vec3& F0, const Vec3& F1, double F_max) noexcept {
  const Vec3 d = F1 - F0;
  const double size = d.norm();
  if (size > 2.0 * F_max) return F0 + d * (F_max / size);
  if (size > F_max) return 0.5 * (F0 + F1);
  return F1;
}

Wrench smooth_wrench(const SmoothingSettings& settings, SmoothingState& state,
                     const Wrench& computed) noexcept {
  state.shown.f = smoothed(state.shown.f, computed.f, settings.max_force_step_N);
  state.shown.t = smoothed(state.shown.t, computed.t, settings.max_torque_step_Nm);
  return state.shown;
}

}  // namespace tactum
