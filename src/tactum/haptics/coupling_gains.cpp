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

/// Lever between turning and pushing for a handle that cannot be turned: k_r = k_t (0.2 m)^2, four times that
/// of a fist, so that a part of a hand's size gives way in translation first.
constexpr double kLever_m = 0.2;

/// Everything that bounds one half of the coupling, translation or rotation.
struct Half {
  double device_damping, hand_damping, mass, friction, encoder_step, stiffest;
};

double damper_of(const Half& half, double period_s, double delay_s) {
  return std::min(kDamperShare * half.hand_damping, kUsed * damper_allowed(half.mass, period_s, delay_s));
}

GainBounds bounds_of(const Half& half, double damper, double period_s, double delay_s) {
  GainBounds bounds;
  bounds.alone = stiffness_allowed(half.device_damping, 0.0, period_s, delay_s);
  bounds.loose_hand = stiffness_allowed(half.device_damping + half.hand_damping, damper, period_s, delay_s);
  bounds.damper = damper_allowed(half.mass, period_s, delay_s);
  bounds.encoder = half.friction > 0.0 && half.encoder_step > 0.0 ? 2.0 * half.friction / half.encoder_step
                                                                  : std::numeric_limits<double>::infinity();
  return bounds;
}

double chosen(const GainBounds& bounds, double stiffest) {
  const double limit = std::min(kUsed * bounds.loose_hand, bounds.encoder);
  return stiffest > 0.0 ? std::min(limit, stiffest) : limit;
}

HandModel loose_hand() { return *hand_model("loose"); }

/// Three digits, without an exponent.
std::string digits(double value) {
  const double unit = value < 1000.0 ? 0.0 : std::pow(10.0, std::floor(std::log10(value)) - 2.0);
  return unit > 0.0 ? fmt::format("{:.0f}", unit * std::round(value / unit)) : fmt::format("{:.3g}", value);
}

/// One half of the coupling beside its bounds: what a loose hand allows, the device alone, and the mass of
/// its handle.
struct Margin {
  double used, in_hand, alone;
  const char* unit;
  double damper, most_damper, mass;
  const char *damper_unit, *mass_unit;

  bool in_loose_hand() const { return used <= in_hand; }
  bool damps() const { return damper <= most_damper; }
  bool released() const { return used <= alone; }
  bool has_mass() const { return mass > 0.0; }
  std::string text() const { return digits(used) + " " + unit; }
  std::string limit_in_hand() const { return digits(in_hand) + " " + unit; }
  std::string limit_alone() const { return digits(alone) + " " + unit; }
};

std::string joined(const std::string& a, const char* between, const std::string& b) {
  return b.empty() ? a : a + between + b;
}

}  // namespace

double damping_needed(double stiffness, double damping, double period_s, double delay_s) noexcept {
  return stiffness * (0.5 * period_s + delay_s) + std::abs(damping);
}

double stiffness_allowed(double device_damping, double damping, double period_s, double delay_s) noexcept {
  return std::max(0.0, device_damping - std::abs(damping)) / (0.5 * period_s + delay_s);
}

double damper_allowed(double mass, double period_s, double delay_s) noexcept {
  if (!(mass > 0.0)) return std::numeric_limits<double>::infinity();
  const double periods = std::ceil(delay_s / period_s);
  return mass / period_s * 2.0 * std::sin(kPi / (4.0 * periods + 2.0));
}

CouplingGains coupling_gains(const DeviceInfo& info, double rate_Hz) {
  const HandleDynamics& handle = info.handle;
  const HandModel hand = loose_hand();
  const double period_s = 1.0 / rate_Hz;
  const Half linear{handle.damping_Ns_per_m, hand.damping_Ns_per_m, handle.mass_kg,
                    handle.friction_N,       handle.encoder_step_m, info.max_stiffness_N_per_m};
  const Half turning{handle.damping_Nms_per_rad, hand.damping_Nms_per_rad, handle.inertia_kg_m2,
                     handle.friction_Nm,         handle.encoder_step_rad,  info.max_stiffness_Nm_per_rad};
  CouplingGains gains;
  gains.coupling.damping_Ns_per_m = damper_of(linear, period_s, handle.delay_s);
  gains.coupling.damping_Nms_per_rad = damper_of(turning, period_s, handle.delay_s);
  gains.translation = bounds_of(linear, gains.coupling.damping_Ns_per_m, period_s, handle.delay_s);
  gains.coupling.stiffness_N_per_m = chosen(gains.translation, linear.stiffest);
  if (info.actuates_torque) {
    gains.rotation = bounds_of(turning, gains.coupling.damping_Nms_per_rad, period_s, handle.delay_s);
    gains.coupling.stiffness_Nm_per_rad = chosen(gains.rotation, turning.stiffest);
  } else {
    constexpr double kInfinite = std::numeric_limits<double>::infinity();
    gains.rotation = {kInfinite, kInfinite, kInfinite, kInfinite};
    gains.coupling.stiffness_Nm_per_rad = gains.coupling.stiffness_N_per_m * kLever_m * kLever_m;
    gains.coupling.damping_Nms_per_rad = 0.0;
  }
  return gains;
}

PortSettings port_settings(const DeviceInfo& info) {
  const HandleDynamics& handle = info.handle;
  PortSettings port;
  port.actuates_torque = info.actuates_torque;
  port.keeps_balance = true;
  port.damping_Ns_per_m = handle.damping_Ns_per_m;
  port.damping_Nms_per_rad = handle.damping_Nms_per_rad;
  port.friction_N = handle.friction_N;
  port.friction_Nm = handle.friction_Nm;
  port.delay_s = handle.delay_s;
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

namespace {

/// Both halves, as far as the device has them.
struct Margins {
  Margin push, turn;
  bool turns;  // the device sends torque
};
Margins margins_of(const Coupling& coupling, const DeviceInfo& info, double rate_Hz) {
  const double period_s = 1.0 / rate_Hz;
  const HandModel hand = loose_hand();
  const HandleDynamics& handle = info.handle;
  const auto allowed = [&](double damping, double damper) {
    return stiffness_allowed(damping, damper, period_s, handle.delay_s);
  };
  return {{coupling.stiffness_N_per_m,
           allowed(handle.damping_Ns_per_m + hand.damping_Ns_per_m, coupling.damping_Ns_per_m),
           allowed(handle.damping_Ns_per_m, 0.0), "N/m", coupling.damping_Ns_per_m,
           damper_allowed(handle.mass_kg, period_s, handle.delay_s), handle.mass_kg, "N s/m", "kg"},
          {coupling.stiffness_Nm_per_rad,
           allowed(handle.damping_Nms_per_rad + hand.damping_Nms_per_rad, coupling.damping_Nms_per_rad),
           allowed(handle.damping_Nms_per_rad, 0.0), "N m/rad", coupling.damping_Nms_per_rad,
           damper_allowed(handle.inertia_kg_m2, period_s, handle.delay_s), handle.inertia_kg_m2, "N m s/rad",
           "kg m^2"},
          info.actuates_torque};
}

bool is_too_stiff(const Margins& margins) {
  return !margins.push.in_loose_hand() || (margins.turns && !margins.turn.in_loose_hand());
}

Stability stability_of(const Margins& margins) {
  const auto& [push, turn, turns] = margins;
  if (is_too_stiff(margins) || !push.damps() || (turns && !turn.damps())) return Stability::kUncertain;
  return push.released() && (!turns || turn.released()) ? Stability::kAlways : Stability::kInHand;
}

}  // namespace

namespace {

/// What the mass of the handle allows of the damper, in a sentence; empty where it is unknown.
std::string damper_sentence(const Margins& margins) {
  const auto part = [](const Margin& margin) {
    return fmt::format("{} {} on {:.3g} {} (limit {})", digits(margin.damper), margin.damper_unit,
                       margin.mass, margin.mass_unit, digits(margin.most_damper));
  };
  const Margin &push = margins.push, &turn = margins.turn;
  const bool turns = margins.turns && turn.has_mass();
  if (!push.has_mass() && !turns) return "";
  const bool good = push.damps() && (!turns || turn.damps());
  return std::string(" Its damper is ") + (good ? "weak" : "not weak") + " enough for the handle: " +
         joined(push.has_mass() ? part(push) : part(turn), " and ",
                push.has_mass() && turns ? part(turn) : "") +
         ".";
}

}  // namespace

Stability stability_of(const Coupling& coupling, const DeviceInfo& info, double rate_Hz) {
  return stability_of(margins_of(coupling, info, rate_Hz));
}

std::string margin_sentence(const Coupling& coupling, const DeviceInfo& info, double rate_Hz) {
  const Margins margins = margins_of(coupling, info, rate_Hz);
  const Stability stability = stability_of(margins);
  const auto both = [&margins](std::string (Margin::*text)() const) {
    return joined((margins.push.*text)(), " and ", margins.turns ? (margins.turn.*text)() : "");
  };
  std::string text = "The coupling of " + both(&Margin::text);
  if (stability == Stability::kUncertain && !is_too_stiff(margins))
    text += " may swing on this device when it is let go, since its damper is too strong";
  else if (stability == Stability::kUncertain)
    text += fmt::format(
        " is too stiff for this device: in a loose hand it may buzz (limit {}), and let go (limit {}) as "
        "well",
        both(&Margin::limit_in_hand), both(&Margin::limit_alone));
  else if (stability == Stability::kInHand)
    text += fmt::format(" is stable in any hand that holds the device; let go, it may buzz (limit {})",
                        both(&Margin::limit_alone));
  else
    text += " is stable in any hand that holds the device, and when it is let go";
  text += stability == Stability::kAlways ? "." : "; its stiffness is lowered where it does.";
  text += damper_sentence(margins);
  if (!margins.turns) text += " The device sends no torque: turns of the hand are followed.";
  return text + " See docs/algorithms/stability.md.";
}

}  // namespace tactum::inline v0_1
