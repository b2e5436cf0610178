#include "tactum/haptics/coupling_gains.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tactum/devices/hand_model.h"
#include "tactum/response/workspace_scale.h"

namespace tactum::inline v0_1 {
namespace {

constexpr double kUsed = 0.5;         // the fraction of the bound that is used
constexpr double kDamperShare = 0.1;  // fraction of the hand's damping that becomes the coupling's damper

/// Of a handle whose inertia is not given: the lightest of the presets.
constexpr double kLightest_kg = 0.045;
constexpr double kLightest_kg_m2 = 2e-5;  // [kg m^2]

/// Damping that is computed from the displacement of one frame is itself late by half a frame; a tenth of m /
/// T is far from where that oscillates. And one encoder step of noise must not push by more than this
/// fraction of the limit.
constexpr double kInjectedShare = 0.1;
constexpr double kNoiseShare = 0.05;

/// Lever between turning and pushing for a handle that cannot be turned: k_r = k_t (0.2 m)^2, four times that
/// of a fist, so that a part of a hand's size gives way in translation first.
constexpr double kLever_m = 0.2;

/// Everything that bounds one half of the coupling, translation or rotation.
struct Half {
  double device_damping, hand_damping, friction, encoder_step, stiffest;
};

GainBounds bounds_of(const Half& half, double damper, double period_s, double delay_s) {
  GainBounds bounds;
  bounds.alone = stiffness_allowed(half.device_damping, 0.0, period_s, delay_s);
  bounds.loose_hand = stiffness_allowed(half.device_damping + half.hand_damping, damper, period_s, delay_s);
  bounds.encoder = half.friction > 0.0 && half.encoder_step > 0.0 ? 2.0 * half.friction / half.encoder_step
                                                                  : std::numeric_limits<double>::infinity();
  return bounds;
}

double chosen(const GainBounds& bounds, double stiffest) {
  const double limit = std::min(kUsed * bounds.loose_hand, bounds.encoder);
  return stiffest > 0.0 ? std::min(limit, stiffest) : limit;
}

double injected(double inertia, double force, double step, double period_s) {
  const double by_inertia = kInjectedShare * inertia / period_s;
  return step > 0.0 ? std::min(by_inertia, kNoiseShare * force * period_s / step) : by_inertia;
}

HandModel loose_hand() { return *hand_model("loose"); }

std::string share(double used, double bound, const char* unit) {
  if (!(bound > 0.0)) return fmt::format("none is allowed ({} {})", used, unit);
  return fmt::format("{:.0f} % of {:.3g} {}", 100.0 * used / bound, bound, unit);
}

}  // namespace

double damping_needed(double stiffness, double damping, double period_s, double delay_s) noexcept {
  return stiffness * (0.5 * period_s + delay_s) + std::abs(damping);
}

double stiffness_allowed(double device_damping, double damping, double period_s, double delay_s) noexcept {
  return std::max(0.0, device_damping - std::abs(damping)) / (0.5 * period_s + delay_s);
}

CouplingGains coupling_gains(const DeviceInfo& info, double rate_Hz) {
  const HandleDynamics& handle = info.handle;
  const HandModel hand = loose_hand();
  const double period_s = 1.0 / rate_Hz;
  const Half linear{handle.damping_Ns_per_m, hand.damping_Ns_per_m, handle.friction_N, handle.encoder_step_m,
                    info.max_stiffness_N_per_m};
  const Half turning{handle.damping_Nms_per_rad, hand.damping_Nms_per_rad, handle.friction_Nm,
                     handle.encoder_step_rad, info.max_stiffness_Nm_per_rad};
  CouplingGains gains;
  gains.coupling.damping_Ns_per_m = kDamperShare * hand.damping_Ns_per_m;
  gains.coupling.damping_Nms_per_rad = kDamperShare * hand.damping_Nms_per_rad;
  gains.translation = bounds_of(linear, gains.coupling.damping_Ns_per_m, period_s, handle.delay_s);
  gains.coupling.stiffness_N_per_m = chosen(gains.translation, linear.stiffest);
  if (info.actuates_torque) {
    gains.rotation = bounds_of(turning, gains.coupling.damping_Nms_per_rad, period_s, handle.delay_s);
    gains.coupling.stiffness_Nm_per_rad = chosen(gains.rotation, turning.stiffest);
  } else {
    constexpr double kInfinite = std::numeric_limits<double>::infinity();
    gains.rotation = {kInfinite, kInfinite, kInfinite};
    gains.coupling.stiffness_Nm_per_rad = gains.coupling.stiffness_N_per_m * kLever_m * kLever_m;
    gains.coupling.damping_Nms_per_rad = 0.0;
  }
  return gains;
}

PortSettings port_settings(const DeviceInfo& info, double rate_Hz) {
  const HandleDynamics& handle = info.handle;
  const double period_s = 1.0 / rate_Hz;
  PortSettings port;
  port.actuates_torque = info.actuates_torque;
  port.damping_Ns_per_m = handle.damping_Ns_per_m;
  port.damping_Nms_per_rad = handle.damping_Nms_per_rad;
  port.max_injected_Ns_per_m = injected(handle.mass_kg > 0.0 ? handle.mass_kg : kLightest_kg,
                                        info.max_force_N, handle.encoder_step_m, period_s);
  port.max_injected_Nms_per_rad =
      injected(handle.inertia_kg_m2 > 0.0 ? handle.inertia_kg_m2 : kLightest_kg_m2, info.max_torque_Nm,
               handle.encoder_step_rad, period_s);
  return port;
}

std::string scale_sentence(const Coupling& coupling, double scale) {
  if (scale == 1.0) return "";
  const Coupling scaled = in_scene(coupling, scale);
  return fmt::format(
      "workspace scale {:.3g}: that coupling is {:.3g} N/m and {:.3g} N m/rad in the scene, whose forces are "
      "felt as they are, and whose torques divided by the scale",
      scale, scaled.stiffness_N_per_m, scaled.stiffness_Nm_per_rad);
}

std::string margin_sentence(const Coupling& coupling, const DeviceInfo& info, double rate_Hz) {
  const double period_s = 1.0 / rate_Hz;
  const HandModel hand = loose_hand();
  const auto allowed = [&](double damping, double damper) {
    return stiffness_allowed(damping, damper, period_s, info.handle.delay_s);
  };
  std::string text = fmt::format(
      "coupling {:.3g} N/m: {} in a loose hand, {} alone", coupling.stiffness_N_per_m,
      share(coupling.stiffness_N_per_m,
            allowed(info.handle.damping_Ns_per_m + hand.damping_Ns_per_m, coupling.damping_Ns_per_m), "N/m"),
      share(coupling.stiffness_N_per_m, allowed(info.handle.damping_Ns_per_m, 0.0), "N/m"));
  if (!info.actuates_torque) return text + "; rotation follows, no torque is sent";
  return text + fmt::format("; {:.3g} N m/rad: {}, {}", coupling.stiffness_Nm_per_rad,
                            share(coupling.stiffness_Nm_per_rad,
                                  allowed(info.handle.damping_Nms_per_rad + hand.damping_Nms_per_rad,
                                          coupling.damping_Nms_per_rad),
                                  "N m/rad"),
                            share(coupling.stiffness_Nm_per_rad,
                                  allowed(info.handle.damping_Nms_per_rad, 0.0), "N m/rad"));
}

}  // namespace tactum::inline v0_1
