#include "tactum/drivers/virtuose.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace tactum::inline v0_1 {
namespace {

/// Numbers that no function of the library tells. Weak ones, until a device has been measured.
constexpr double kVirtStiffness_N_per_m = 1000.0, kVirtStiffness_Nm_per_rad = 5.0;
constexpr double kVirtRadius_m = 0.1;
constexpr int kLeastVersion = 4;

Vec3 virt_vector(const float* v) noexcept { return {v[0], v[1], v[2]}; }

/// Limits that a wrench still keeps when it has been rounded to float.
DeviceInfo below_rounding(DeviceInfo info) {
  constexpr double kBelow = 1.0 - static_cast<double>(std::numeric_limits<float>::epsilon());
  info.max_force_N *= kBelow;
  info.max_torque_Nm *= kBelow;
  return info;
}

}  // namespace

Result<std::unique_ptr<Device>> VirtuoseDevice::connect(const VirtuoseOptions& options) {
  std::unique_ptr<VirtuoseDevice> device(new VirtuoseDevice(options));
  if (device->options_.host.empty()) device->options_.host = kHost;
  if (Result<void> connected = device->connect_once(); !connected) return connected.error();
  return std::unique_ptr<Device>(std::move(device));
}

/// The library keeps its last error for each context; a context of null has that of opening.
Error VirtuoseDevice::failure(const std::string& what) const {
  const int code = virtuose_.call.error_code(context_);
  const char* said = virtuose_.call.error_message(code);
  return {
      what, (said == nullptr ? "" : said) + std::string(" (") + std::to_string(code) + ")",
      "a controller that is switched on and reached at HOST#PORT, as in virtuose:192.168.1.1#5126, and that "
      "no other program holds",
      options_.host};
}

Result<void> VirtuoseDevice::connect_once() {
  if (context_ != nullptr) return {};
  Result<VirtuoseLibrary> loaded = VirtuoseLibrary::load();
  if (!loaded) return loaded.error();
  virtuose_ = std::move(*loaded);
  int major = 0, minor = 0;
  if (virtuose_.call.api_version(&major, &minor) != 0 || major < kLeastVersion)
    return Error{"the library of Haption is too old", std::to_string(major) + "." + std::to_string(minor),
                 "VirtuoseAPI 4", virtuose_.library.path()};
  context_ = virtuose_.call.open(options_.host.c_str());
  if (context_ == nullptr) return failure("no Virtuose answers");
  Result<void> asked = ask_abilities();
  if (!asked) close();
  return asked;
}

Result<void> VirtuoseDevice::ask_abilities() {
  int type = 0, serial = 0, axes = 0;
  if (virtuose_.call.device_id(context_, &type, &serial) != 0 ||
      virtuose_.call.axis_count(context_, &axes) != 0)
    return failure("the Virtuose does not tell what it is");
  const bool turns = axes >= 6;
  info_.name = "virtuose of type " + std::to_string(type);
  info_.serial = std::to_string(serial);
  info_.is_hardware = true;
  info_.senses_rotation = turns;
  info_.actuates_force = true;
  info_.actuates_torque = turns;
  info_.max_force_N = kMostForce_N;
  info_.max_torque_Nm = turns ? kMostTorque_Nm : 0.0;
  info_.max_stiffness_N_per_m = kVirtStiffness_N_per_m;
  info_.max_stiffness_Nm_per_rad = turns ? kVirtStiffness_Nm_per_rad : 0.0;
  info_.workspace_radius_m = kVirtRadius_m;
  info_.handle.delay_s = kPeriod_s;
  return {};
}

DriverSurvey VirtuoseDevice::survey() {
  DriverSurvey survey{"virtuose", {}, ""};
  VirtuoseDevice device({.host = kHost});
  if (const Result<void> connected = device.connect_once(); !connected) {
    survey.nothing = connected.error().message();
    return survey;
  }
  int operational = 0;
  const bool ready =
      device.virtuose_.call.get_emergency_stop(device.context_, &operational) == 0 && operational == 1;
  survey.found.push_back(
      {"virtuose", device.info_, ready ? "" : "its emergency stop is pressed: release it"});
  return survey;
}

/// The order matters: the time step before the command type, the limits before the power.
Result<void> VirtuoseDevice::prepare() {
  const VirtuoseFunctions& call = virtuose_.call;
  std::array<float, 7> identity{0, 0, 0, 0, 0, 0, 1};
  std::array<float, 7> pose{};
  if (call.set_indexing(context_, virt::kNoIndexing) != 0) return failure("cannot switch the indexing off");
  if (call.set_force_factor(context_, 1.0f) != 0 || call.set_speed_factor(context_, 1.0f) != 0)
    return failure("cannot set the scale of force and speed to one");
  if (call.set_time_step(context_, period_s_) != 0) return failure("cannot set the time step");
  if (call.set_base_frame(context_, identity.data()) != 0 ||
      call.set_observation_frame(context_, identity.data()) != 0)
    return failure("cannot set the frames");
  if (call.set_command_type(context_, virt::kImpedance) != 0) return failure("cannot set the impedance mode");
  if (call.saturate(context_, static_cast<float>(info_.max_force_N),
                    static_cast<float>(info_.max_torque_Nm)) != 0)
    return failure("cannot set the limits");
  if (call.get_pose(context_, pose.data()) != 0) return failure("cannot measure where the handle is");
  origin_ = virt_vector(pose.data());
  if (!origin_.allFinite()) return Error{"the handle is nowhere", "a number that is not finite", "", ""};
  if (call.enable_force(context_, 1) != 0) return failure("cannot switch the force on");
  if (call.set_power(context_, 1) != 0) return failure("cannot switch the power on");
  if (!send({})) return failure("cannot send a zero wrench");
  return {};
}

Result<void> VirtuoseDevice::start() {
  if (Result<void> prepared = prepare(); !prepared) return prepared;
  exchange_.start(CommandGate(below_rounding(info_)), options_.stale_after_s);
  powered_ticks_ = 0;
  has_force_ = true;
  error_ = 0;
  grip_sensed_ = operational_ = powered_ = true;
  if (virtuose_.call.set_periodic(context_, on_tick, &period_s_, this) != 0)
    return failure("cannot have the library call us");
  if (virtuose_.call.start_loop(context_) != 0) return failure("cannot start the library's loop");
  runs_ = true;
  if (exchange_.served_twice()) return {};
  return Error{"the library's loop does not run", "no call within a second", "a controller that answers",
               options_.host};
}

Result<void> VirtuoseDevice::open() {
  if (is_open_) return {};
  if (Result<void> connected = connect_once(); !connected) return connected;
  Result<void> started = start();
  is_open_ = static_cast<bool>(started);
  if (!started) close();
  return started;
}

void VirtuoseDevice::close() noexcept {
  if (runs_) {
    exchange_.write({});
    exchange_.served_twice();  // so that the zero is sent
    virtuose_.call.stop_loop(context_);
  }
  if (context_ != nullptr) {
    send({});
    virtuose_.call.enable_force(context_, 0);
    virtuose_.call.set_power(context_, 0);
    virtuose_.call.close(context_);
  }
  context_ = nullptr;
  is_open_ = runs_ = false;
  virtuose_ = {};
}

void VirtuoseDevice::on_tick(virt::Context, void* self) noexcept {
  static_cast<VirtuoseDevice*>(self)->tick();
}

/// On the library's thread.
void VirtuoseDevice::tick() noexcept {
  DeviceSample& sample = exchange_.sample();
  const bool answered = measure(sample) && ask_state(sample);
  const Wrench F = answered && sample.motors_on ? exchange_.command() : Wrench{};
  const bool sent = send(F);
  if (!answered || !sent) {
    if (error_ == 0) error_ = virtuose_.call.error_code(context_);
    exchange_.lose();
  }
  exchange_.publish();
}

/// False when a call fails, or when what it gave cannot be a pose.
bool VirtuoseDevice::measure(DeviceSample& sample) noexcept {
  std::array<float, 7> pose{};
  std::array<float, 6> speed{}, force{};
  if (virtuose_.call.get_pose(context_, pose.data()) != 0 ||
      virtuose_.call.get_speed(context_, speed.data()) != 0)
    return false;
  const Eigen::Quaterniond turn(pose[6], pose[3], pose[4], pose[5]);
  if (!(turn.norm() > 0.5)) return false;  // a buffer of zeros
  sample.X_DH = {turn.normalized().toRotationMatrix(), virt_vector(pose.data()) - origin_};
  sample.V_DH = {virt_vector(speed.data()), virt_vector(speed.data() + 3)};
  sample.has_velocity = true;
  // It tells the force on the object that the handle holds, not on the hand, and not in every mode.
  has_force_ = has_force_ && virtuose_.call.get_force(context_, force.data()) == 0;
  sample.has_delivered = has_force_;
  sample.F_D_delivered = {-virt_vector(force.data()), -virt_vector(force.data() + 3)};
  return plausible(sample.X_DH);
}

bool VirtuoseDevice::ask_state(DeviceSample& sample) noexcept {
  int grip_sensed = 0, operational = 0, power = 0;
  if (virtuose_.call.get_dead_man(context_, &grip_sensed) != 0 ||
      virtuose_.call.get_emergency_stop(context_, &operational) != 0 ||
      virtuose_.call.get_power(context_, &power) != 0)
    return false;
  sample.buttons = 0;
  for (int number = 0; number < kButtons; ++number) {
    int pressed = 0;  // not every model has all of them
    if (virtuose_.call.get_button(context_, number, &pressed) == 0 && pressed != 0)
      sample.buttons |= 1u << static_cast<unsigned>(number);
  }
  grip_sensed_ = grip_sensed != 0;
  operational_ = operational == 1;
  powered_ = power != 0;
  const int relays_ticks = static_cast<int>(std::lround(options_.relays_s / kPeriod_s));
  powered_ticks_ = power == 0 ? 0 : std::min(powered_ticks_ + 1, relays_ticks + 1);
  sample.motors_on = grip_sensed_ && operational_ && powered_ticks_ > relays_ticks;
  return true;
}

bool VirtuoseDevice::send(const Wrench& F_D) const noexcept {
  std::array<float, 6> wrench{};
  for (int axis = 0; axis < 3; ++axis) {
    const auto at = static_cast<std::size_t>(axis);
    wrench[at] = static_cast<float>(F_D.f[axis]);
    wrench[at + 3] = static_cast<float>(F_D.t[axis]);
  }
  return virtuose_.call.set_force(context_, wrench.data()) == 0;
}

bool VirtuoseDevice::read(double now_s, DeviceSample& sample) noexcept {
  sample.valid = false;
  return is_open_ && exchange_.read(now_s, sample);
}

bool VirtuoseDevice::write(const Wrench& F_D) noexcept { return is_open_ && exchange_.write(F_D); }

std::string VirtuoseDevice::trouble() const {
  if (exchange_.lost()) {
    const bool can_say = error_ != 0 && virtuose_.library.loaded();
    const char* said = can_say ? virtuose_.call.error_message(error_) : nullptr;
    return "the Virtuose does not answer" + (said == nullptr ? "" : " (" + std::string(said) + ")") +
           ": see that its controller is on and its network holds, and start anew";
  }
  if (!operational_) return "the emergency stop is pressed: release it, and start anew";
  if (!powered_) return "the motors have no power: see the controller, and start anew";
  return grip_sensed_ ? "" : "the dead man's sensor is not held: hold the handle";
}

}  // namespace tactum::inline v0_1
