#include "tactum/devices/simulated_device.h"

#include <algorithm>
#include <cmath>

#include "tactum/math/screw.h"

namespace tactum::inline v0_1 {
namespace {

/// `v` no longer than `limit`, its direction kept, as motor groups are scaled together.
Vec3 limited(const Vec3& v, double limit) {
  const double norm = v.norm();
  return norm > limit ? Vec3(v * (limit / norm)) : v;
}

/// Coulomb friction: shortened by `friction`, zero when not longer.
Vec3 rubbed(const Vec3& v, double friction) {
  const double norm = v.norm();
  return norm > friction ? Vec3(v * (1.0 - friction / norm)) : Vec3(Vec3::Zero());
}

/// One linear or turning half of the handle over a substep.
struct Half {
  double inertia;
  double hand_stiffness;
  double hand_damping;
  double device_damping;
  double friction;
};

/// Moves the velocity over `h` and returns the mean velocity (see the header). `error` is the hand's offset
/// from the handle at mid-step if the handle stood still, `v_hand` the hand's velocity there.
Vec3 midpoint(const Half& half, const Vec3& force, const Vec3& error, const Vec3& v_hand, double h, Vec3& v) {
  const double slowness = 2.0 * half.inertia / h;
  const Vec3 push = slowness * v + force + half.hand_stiffness * error + half.hand_damping * v_hand;
  const Vec3 kept = rubbed(push, half.friction);
  const Vec3 u = kept / (slowness + 0.5 * h * half.hand_stiffness + half.hand_damping + half.device_damping);
  // Friction larger than the whole push stops the handle; 2u - v would leave it quivering.
  const bool stuck = half.friction > 0.0 && kept.isZero(0.0);
  v = stuck ? Vec3(Vec3::Zero()) : Vec3(2.0 * u - v);
  return u;
}

Vec3 on_grid(const Vec3& v, double step) {
  if (step <= 0.0) return v;
  return {std::round(v.x() / step) * step, std::round(v.y() / step) * step, std::round(v.z() / step) * step};
}

Result<void> check(const SimulatedDeviceModel& model) {
  const auto bad = [&](const char* what, double found, const char* expected) {
    return Error{what, std::to_string(found), expected, "simulated device " + model.name};
  };
  if (!(model.mass_kg > 0.0)) return bad("bad mass", model.mass_kg, "more than 0 kg");
  if (!(model.inertia_kg_m2 > 0.0)) return bad("bad inertia", model.inertia_kg_m2, "more than 0 kg m^2");
  if (!(model.command_delay_s >= 0.0 && model.command_delay_s <= SimulatedDevice::kMaxDelay_s)) {
    return bad("bad delay", model.command_delay_s, "0 to 0.05 s");
  }
  if (!(model.workspace_radius_m > 0.0)) {
    return bad("bad workspace radius", model.workspace_radius_m, "more than 0 m");
  }
  return {};
}

}  // namespace

SimulatedDevice::SimulatedDevice(SimulatedDeviceModel model, HandModel hand,
                                 std::shared_ptr<const HandMotion> motion)
    : model_(std::move(model)), hand_(std::move(hand)), motion_(std::move(motion)) {
  info_.name = "simulated " + model_.name;
  info_.senses_rotation = true;
  info_.actuates_force = model_.max_force_N > 0.0;
  info_.actuates_torque = model_.max_torque_Nm > 0.0;
  info_.max_force_N = model_.max_force_N;
  info_.max_torque_Nm = model_.max_torque_Nm;
  info_.max_stiffness_N_per_m = model_.max_stiffness_N_per_m;
  info_.max_stiffness_Nm_per_rad = model_.max_stiffness_Nm_per_rad;
  info_.workspace_radius_m = model_.workspace_radius_m;
  info_.rate_Hz = model_.rate_Hz;
  info_.handle = {
      model_.mass_kg,        model_.inertia_kg_m2, model_.damping_Ns_per_m, model_.damping_Nms_per_rad,
      model_.friction_N,     model_.friction_Nm,   model_.encoder_step_m,   model_.encoder_step_rad,
      model_.command_delay_s};
}

Result<void> SimulatedDevice::open() {
  if (Result<void> good = check(model_); !good) return good;
  started_ = false;
  world_s_ = slept_s_ = 0.0;
  intended_ = hand_at(0.0);
  place(intended_.X_DH, intended_.V_DH);
  motors_ = {};
  limp_ = true;
  saturated_writes_ = watchdog_trips_ = 0;
  command_count_ = reading_count_ = 0;
  is_open_ = true;
  return {};
}

void SimulatedDevice::close() noexcept {
  motors_ = {};
  command_count_ = 0;
  is_open_ = false;
}

void SimulatedDevice::place(const Pose& X_DH, const Twist& V_DH) noexcept {
  X_DH_ = X_DH;
  V_DH_ = V_DH;
  stop_at_workspace_edge();
}

HandState SimulatedDevice::hand_at(double world_s) const noexcept {
  return motion_ ? motion_->at(world_s) : HandState{};
}

bool SimulatedDevice::read(double now_s, DeviceSample& sample) noexcept {
  if (!is_open_ || !std::isfinite(now_s) || (started_ && now_s < now_s_)) {
    sample.valid = false;
    return false;
  }
  const double elapsed = started_ ? now_s - now_s_ : 0.0;
  started_ = true;
  now_s_ = now_s;
  const double moved_s = std::min(elapsed, kMaxStepsPerRead * kSubstep_s);
  slept_s_ += elapsed - moved_s;
  if (moved_s > 0.0) {
    const int steps = std::max(1, static_cast<int>(std::lround(moved_s / kSubstep_s)));
    for (int i = 0; i < steps; ++i) substep(moved_s / steps);
  }
  sample.time_s = now_s;
  sample.X_DH = encoded();
  sample.buttons = intended_.buttons;
  sample.motors_on = !(limp_ && watchdog_trips_ > 0);  // before the first write there is no fault
  sample.valid = true;
  estimate_velocity(now_s, sample);
  return true;
}

bool SimulatedDevice::write(const Wrench& F_D) noexcept {
  if (!is_open_) return false;
  const bool usable = F_D.finite();
  Wrench F;
  if (usable) F = {limited(F_D.f, model_.max_force_N), limited(F_D.t, model_.max_torque_Nm)};
  if (usable && (F.f != F_D.f || F.t != F_D.t)) ++saturated_writes_;
  last_write_s_ = world_s_;
  limp_ = false;
  const double due_s = world_s_ + model_.command_delay_s;
  const int newest = (command_tail_ + command_count_ - 1 + kCommandRoom) % kCommandRoom;
  // Two writes without a read between them, or more of them than the line holds: the newest counts.
  if (command_count_ > 0 && (commands_[newest].due_s == due_s || command_count_ == kCommandRoom)) {
    commands_[newest] = {due_s, F};
  } else {
    commands_[(command_tail_ + command_count_) % kCommandRoom] = {due_s, F};
    ++command_count_;
  }
  return usable;
}

void SimulatedDevice::update_motors() noexcept {
  // Half a substep of grace: rounding of the clock must not delay a command by a whole one.
  const double due = world_s_ + 0.5 * kSubstep_s;
  while (command_count_ > 0 && commands_[command_tail_].due_s <= due) {
    motors_ = commands_[command_tail_].F;
    command_tail_ = (command_tail_ + 1) % kCommandRoom;
    --command_count_;
  }
  if (!limp_ && world_s_ - last_write_s_ >= model_.watchdog_s) {
    limp_ = true;
    ++watchdog_trips_;
  }
  if (limp_) {
    motors_ = {};
    command_count_ = 0;
  }
}

void SimulatedDevice::substep(double h) noexcept {
  update_motors();
  move_handle(hand_at(world_s_ + 0.5 * h), h);
  stop_at_workspace_edge();
  world_s_ += h;
  intended_ = hand_at(world_s_);
}

void SimulatedDevice::move_handle(const HandState& hand, double h) noexcept {
  const Half linear{total_mass(), hand_.stiffness_N_per_m, hand_.damping_Ns_per_m, model_.damping_Ns_per_m,
                    model_.friction_N};
  const Half turning{total_inertia(), hand_.stiffness_Nm_per_rad, hand_.damping_Nms_per_rad,
                     model_.damping_Nms_per_rad, model_.friction_Nm};
  const Vec3 u = midpoint(linear, motors_.f, hand.X_DH.p - X_DH_.p, hand.V_DH.v, h, V_DH_.v);
  const Vec3 turn = log_rotation(hand.X_DH.R * X_DH_.R.transpose());
  const Vec3 w = midpoint(turning, motors_.t, turn, hand.V_DH.w, h, V_DH_.w);
  X_DH_ = renormalized({exp_rotation(w * h) * X_DH_.R, X_DH_.p + u * h});
}

void SimulatedDevice::stop_at_workspace_edge() noexcept {
  const double distance = X_DH_.p.norm();
  if (distance <= model_.workspace_radius_m) return;
  const Vec3 outward = X_DH_.p / distance;
  X_DH_.p = outward * model_.workspace_radius_m;
  const double speed = V_DH_.v.dot(outward);
  if (speed > 0.0) V_DH_.v -= speed * outward;  // the stop takes the impact without rebound
}

double SimulatedDevice::energy_J() const noexcept {
  const Vec3 turn = log_rotation(intended_.X_DH.R * X_DH_.R.transpose());
  return 0.5 * (total_mass() * V_DH_.v.squaredNorm() + total_inertia() * V_DH_.w.squaredNorm() +
                hand_.stiffness_N_per_m * (intended_.X_DH.p - X_DH_.p).squaredNorm() +
                hand_.stiffness_Nm_per_rad * turn.squaredNorm());
}

Pose SimulatedDevice::encoded() const noexcept {
  Pose X = X_DH_;
  X.p = on_grid(X.p, model_.encoder_step_m);
  if (model_.encoder_step_rad > 0.0) {
    X.R = exp_rotation(on_grid(log_rotation(X.R), model_.encoder_step_rad));
  }
  return X;
}

void SimulatedDevice::estimate_velocity(double now_s, DeviceSample& sample) noexcept {
  sample.V_DH = {};
  sample.has_velocity = false;
  if (model_.velocity_window_s <= 0.0) return;
  // The oldest reading inside the window (or the last one before, at low rates) spans the difference.
  int best = -1;
  for (int back = 1; back <= reading_count_; ++back) {
    const int i = (reading_head_ - back + kReadingRoom) % kReadingRoom;
    if (now_s - readings_[i].time_s <= 0.0) continue;
    if (best >= 0 && now_s - readings_[i].time_s > model_.velocity_window_s + 0.5 * kSubstep_s) break;
    best = i;
  }
  if (best >= 0) {
    sample.V_DH = twist_between(readings_[best].X, sample.X_DH, now_s - readings_[best].time_s);
    sample.has_velocity = true;
  }
  readings_[reading_head_] = {now_s, sample.X_DH};
  reading_head_ = (reading_head_ + 1) % kReadingRoom;
  reading_count_ = std::min(reading_count_ + 1, kReadingRoom);
}

}  // namespace tactum::inline v0_1
