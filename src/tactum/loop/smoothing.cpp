#include "tactum/loop/smoothing.h"

#include "tactum/base/frame_rate.h"

namespace tactum::inline v0_1 {

Vec3 smoothed(const Vec3& F0, const Vec3& F1, double F_max) noexcept {
  const Vec3 d = F1 - F0;
  const double size = d.norm();
  if (size > 2.0 * F_max) return F0 + d * (F_max / size);
  if (size > F_max) return 0.5 * (F0 + F1);
  return F1;
}

Wrench smooth_wrench(const SmoothingSettings& settings, double dt_s, SmoothingState& state,
                     const Wrench& computed) noexcept {
  if (!settings.on) {
    state.shown = computed;
    return state.shown;
  }
  const double steps = dt_s / kReferenceStep_s;
  state.shown.f = smoothed(state.shown.f, computed.f, settings.max_force_step_N * steps);
  state.shown.t = smoothed(state.shown.t, computed.t, settings.max_torque_step_Nm * steps);
  return state.shown;
}

}  // namespace tactum::inline v0_1
