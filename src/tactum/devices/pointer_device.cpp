#include "tactum/devices/pointer_device.h"

#include <algorithm>
#include <cmath>

#include "tactum/math/screw.h"

namespace tactum::inline v0_1 {
namespace {

/// Error and its rate after `t` of a critically damped spring of rate w.
struct Damped {
  Vec3 e, v;
};
Damped damped(const Vec3& e0, const Vec3& v0, double w, double t) {
  const Vec3 slope = v0 + w * e0;
  const double fade = std::exp(-w * t);
  return {(e0 + slope * t) * fade, (v0 - w * t * slope) * fade};
}

Vec3 no_longer_than(const Vec3& v, double limit) {
  const double norm = v.norm();
  return norm > limit ? Vec3(v * (limit / norm)) : v;
}

}  // namespace

PointerDevice::PointerDevice(const SimulatedDeviceModel& model, const HandModel& hand,
                             std::shared_ptr<const HandMotion> script)
    : script_(std::move(script)),
      hand_(std::make_shared<Hand>()),
      device_(model, hand, hand_),
      info_(device_.info()) {
  info_.name = "pointer on " + model.name;
}

Result<void> PointerDevice::open() {
  started_ = aimed_ = false;
  world_s_ = 0.0;
  buttons_ = 0;
  V_aim_ = {};
  *hand_ = {};
  hand_->X_DH = scripted(0.0, hand_->buttons);
  return device_.open();
}

HandState PointerDevice::Hand::at(double world_s) const noexcept {
  const double since = std::clamp(world_s, start_s, end_s) - start_s;
  return {advanced(X_DH, V_DH, since), V_DH, buttons};
}

/// Forth and back: the path is passable in either direction, a leap from its end to its start may not be.
Pose PointerDevice::scripted(double world_s, std::uint32_t& buttons) const noexcept {
  if (!script_) return {};
  const double length = script_->duration_s();
  const double phase = length > 0.0 ? std::fmod(world_s, 2.0 * length) : 0.0;
  const HandState state = script_->at(phase <= length ? phase : 2.0 * length - phase);
  buttons = state.buttons;
  return state.X_DH;
}

Pose PointerDevice::follow(double step_s) noexcept {
  const Pose& X = hand_->X_DH;
  const Damped p = damped(X.p - X_aim_.p, V_aim_.v, kFollow_per_s, step_s);
  const Damped r = damped(log_rotation(X.R * X_aim_.R.transpose()), V_aim_.w, kFollow_per_s, step_s);
  Twist V = twist_between(X, {exp_rotation(r.e) * X_aim_.R, X_aim_.p + p.e}, step_s);
  V = {no_longer_than(V.v, kMaxSpeed_m_per_s), no_longer_than(V.w, kMaxTurn_rad_per_s)};
  V_aim_ = {no_longer_than(p.v, kMaxSpeed_m_per_s), no_longer_than(r.v, kMaxTurn_rad_per_s)};
  return renormalized(advanced(X, V, step_s));
}

bool PointerDevice::read(double now_s, DeviceSample& sample) noexcept {
  const double longest = SimulatedDevice::kMaxStepsPerRead * SimulatedDevice::kSubstep_s;
  const double step_s = started_ ? std::clamp(now_s - now_s_, 0.0, longest) : 0.0;
  if (step_s > 0.0) {
    hand_->X_DH = hand_->at(hand_->end_s).X_DH;
    hand_->start_s = world_s_;
    hand_->end_s = world_s_ += step_s;
    hand_->buttons = buttons_;
    const Pose X_end = aimed_ ? follow(step_s) : scripted(world_s_, hand_->buttons);
    hand_->V_DH = twist_between(hand_->X_DH, X_end, step_s);
  }
  if (std::isfinite(now_s)) {
    started_ = true;
    now_s_ = now_s;
  }
  return device_.read(now_s, sample);
}

void PointerDevice::aim(const Pose& X_DH, std::uint32_t buttons) noexcept {
  if (!plausible(X_DH)) return;
  X_aim_ = renormalized(X_DH);
  X_aim_.p = no_longer_than(X_aim_.p, info_.workspace_radius_m);
  buttons_ = buttons;
  aimed_ = true;
}

void PointerDevice::rest() noexcept {
  X_aim_ = hand_->at(hand_->end_s).X_DH;
  buttons_ = 0;
  V_aim_ = {};
  aimed_ = true;
}

}  // namespace tactum::inline v0_1
