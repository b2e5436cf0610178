#include "tactum/devices/replay_device.h"

#include <cmath>

namespace tactum::inline v0_1 {

ReplayDevice::ReplayDevice(std::string name, std::shared_ptr<const HandMotion> motion,
                           const ReplaySettings& settings)
    : motion_(std::move(motion)), settings_(settings) {
  info_.name = "replay of " + std::move(name);
  info_.senses_rotation = true;
  info_.actuates_force = settings.max_force_N > 0.0;
  info_.actuates_torque = settings.max_torque_Nm > 0.0;
  info_.max_force_N = settings.max_force_N;
  info_.max_torque_Nm = settings.max_torque_Nm;
  info_.workspace_radius_m = settings.workspace_radius_m;
}

Result<void> ReplayDevice::open() {
  if (!motion_) return Error{"nothing to replay", "no motion", "a motion", info_.name};
  started_ = finished_ = false;
  writes_ = saturated_writes_ = 0;
  last_ = {};
  is_open_ = true;
  return {};
}

bool ReplayDevice::read(double now_s, DeviceSample& sample) noexcept {
  if (!is_open_ || !std::isfinite(now_s)) {
    sample.valid = false;
    return false;
  }
  if (!started_) start_s_ = now_s;
  started_ = true;
  double time_s = now_s - start_s_;
  const double duration_s = motion_->duration_s();
  if (settings_.at_end == AtEnd::kRepeat && duration_s > 0.0) time_s = std::fmod(time_s, duration_s);
  finished_ = settings_.at_end == AtEnd::kRest && time_s >= duration_s;
  const HandState state = motion_->at(time_s);
  sample.time_s = now_s;
  sample.X_DH = state.X_DH;
  sample.V_DH = state.V_DH;
  sample.has_velocity = true;
  sample.buttons = state.buttons;
  sample.valid = true;
  return true;
}

bool ReplayDevice::write(const Wrench& F_D) noexcept {
  if (!is_open_) return false;
  last_ = {};
  if (!F_D.finite()) return false;
  ++writes_;
  const double force = F_D.f.norm();
  const double torque = F_D.t.norm();
  last_ = F_D;
  if (force > settings_.max_force_N) last_.f *= settings_.max_force_N / force;
  if (torque > settings_.max_torque_Nm) last_.t *= settings_.max_torque_Nm / torque;
  if (force > settings_.max_force_N || torque > settings_.max_torque_Nm) ++saturated_writes_;
  return true;
}

}  // namespace tactum::inline v0_1
