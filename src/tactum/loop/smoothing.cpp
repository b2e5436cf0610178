#include "tactum/loop/smoothing.h"

#include <algorithm>
#include <cmath>

namespace tactum::inline v0_1 {
namespace {

/// For so long what the hand has explained fades [s].
constexpr double kFades_s = 0.005;

/// `F1`, or the point on the way to it from `F0` that is `longest` away.
Vec3 within_step(const Vec3& F0, const Vec3& F1, double longest) noexcept {
  const Vec3 d = F1 - F0;
  const double size = d.norm();
  return size > longest ? Vec3(F0 + d * (longest / size)) : F1;
}

/// The limits of force, or of torque.
struct Limits {
  double explained, beyond_hand_per_s, most_per_s, reversal_per_s, dt_s;
};

/// What to show after `F0` and the step that led there.
Vec3 next_shown(const Limits& limits, const Vec3& F0, const Vec3& last_step, const Vec3& computed) noexcept {
  const double by_hand = std::max(limits.explained, limits.beyond_hand_per_s * limits.dt_s);
  const Vec3 F1 = smoothed(F0, within_step(F0, computed, by_hand), limits.most_per_s * limits.dt_s);
  if (!((F1 - F0).dot(last_step) < 0.0)) return F1;
  // The shorter the last step was, the less there is that turns back: no leap where it was nothing at all.
  const double reversal = limits.reversal_per_s * limits.dt_s;
  const double last = last_step.norm();
  if (!(last < reversal)) return within_step(F0, F1, reversal);
  return within_step(F0, F1, std::max(reversal, by_hand - (by_hand - reversal) * (last / reversal)));
}

}  // namespace

Vec3 smoothed(const Vec3& F0, const Vec3& F1, double F_max) noexcept {
  const Vec3 d = F1 - F0;
  const double size = d.norm();
  if (size > 2.0 * F_max) return F0 + d * (F_max / size);
  if (size > F_max) return 0.5 * (F0 + F1);
  return F1;
}

WrenchStep explained_by(const Twist& displacement, double stiffness_N_per_m, double stiffness_Nm_per_rad,
                        double lever_m) noexcept {
  // The handle is pushed by what a point of the part is pushed, and the other way round.
  const double moved_m = displacement.v.norm(), turned_rad = displacement.w.norm();
  const double force_N = stiffness_N_per_m * (moved_m + lever_m * turned_rad);
  return {force_N, stiffness_Nm_per_rad * turned_rad + lever_m * force_N};
}

Wrench smooth_wrench(const SmoothingSettings& settings, double dt_s, const WrenchStep& explained,
                     SmoothingState& state, const Wrench& computed) noexcept {
  const double kept = std::max(0.0, 1.0 - dt_s / kFades_s);
  state.explained = {std::max(explained.force_N, kept * state.explained.force_N),
                     std::max(explained.torque_Nm, kept * state.explained.torque_Nm)};
  if (!settings.on) {
    state.shown = computed;
    return state.shown;
  }
  const Wrench last = state.shown;
  state.shown.f = next_shown({state.explained.force_N, settings.beyond_hand_N_per_s,
                              settings.max_force_N_per_s, settings.reversal_N_per_s, dt_s},
                             last.f, state.step.f, computed.f);
  state.shown.t = next_shown({state.explained.torque_Nm, settings.beyond_hand_Nm_per_s,
                              settings.max_torque_Nm_per_s, settings.reversal_Nm_per_s, dt_s},
                             last.t, state.step.t, computed.t);
  state.step = state.shown - last;
  return state.shown;
}

}  // namespace tactum::inline v0_1
