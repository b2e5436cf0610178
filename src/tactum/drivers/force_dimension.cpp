#include "tactum/drivers/force_dimension.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tactum/devices/apparent_inertia.h"

namespace tactum::inline v0_1 {
namespace {

/// Numbers of one family that no function of the library tells: its continuous force and torque, the
/// stiffest wall that users find stable, and the sphere within its workspace, after CHAI3D's tables.
struct DhdFamily {
  const char* name;
  std::array<int, 2> types;  // lowest and highest of the library's numbers
  double max_force_N, max_torque_Nm, stiffness_N_per_m, stiffness_Nm_per_rad, radius_m;
};
constexpr DhdFamily kDhdFamilies[] = {
    {"omega", {32, 37}, 12.0, 0.0, 5000.0, 0.0, 0.075},
    {"falcon", {60, 60}, 8.0, 0.0, 3000.0, 0.0, 0.04},
    {"delta", {61, 64}, 20.0, 0.0, 5000.0, 0.0, 0.15},
    {"sigma", {104, 107}, 12.0, 0.2, 4000.0, 1.0, 0.075},
    {"lambda", {108, 109}, 12.0, 0.2, 8000.0, 1.0, 0.1125},
    {"lambda", {131, 132}, 12.0, 0.2, 8000.0, 1.0, 0.1125},
    {"lambda", {203, 203}, 12.0, 0.0, 8000.0, 0.0, 0.1125},
    {"sigma", {206, 206}, 12.0, 0.0, 4000.0, 0.0, 0.075},
};
/// The library has numbers for many more. One that is not known here is taken for a weak one.
constexpr DhdFamily kUnknownFamily = {"", {0, 0}, 8.0, 0.1, 3000.0, 0.3, 0.04};

const DhdFamily& family_of(int type) {
  for (const DhdFamily& family : kDhdFamilies)
    if (type >= family.types[0] && type <= family.types[1]) return family;
  return kUnknownFamily;
}

/// From a write to the motors, and from the encoders to a read: a USB transfer. Assumed, not measured.
constexpr double kTransfer_s = 0.001;
constexpr double kWatchdogTick_s = 125.0e-6;

/// Why no device is there for us, with the cure.
std::string dhd_nothing(const DhdFunctions& call) {
  const int connected = call.device_count();
  if (connected > 0)
    return "every device of Force Dimension that is connected is held by another program: end that program";
  std::string text = "no device of Force Dimension is connected: plug it in and switch it on";
  text +=
      "; if it is, its USB node may not be opened by you: tactum devices --install-udev, then plug it in "
      "anew";
  return connected < 0 ? text + " (the library says: " + call.last_error() + ")" : text;
}

std::string dhd_serial_of(const DhdFunctions& call, char id) {
  unsigned short serial = 0;
  return call.serial_number(&serial, id) < 0 ? "" : std::to_string(serial);
}

}  // namespace

Result<std::unique_ptr<Device>> ForceDimensionDevice::connect(const ForceDimensionOptions& options) {
  std::unique_ptr<ForceDimensionDevice> device(new ForceDimensionDevice(options));
  if (Result<void> connected = device->connect_once(); !connected) return connected.error();
  return std::unique_ptr<Device>(std::move(device));
}

Error ForceDimensionDevice::failure(const std::string& what, const std::string& cure) const {
  const char* said = dhd_.call.last_error();
  return {what, said == nullptr ? "" : said, cure, info_.name.empty() ? "force-dimension" : info_.name};
}

Result<void> ForceDimensionDevice::connect_once() {
  if (id_ >= 0) return {};
  Result<DhdLibrary> loaded = DhdLibrary::load();
  if (!loaded) return loaded.error();
  dhd_ = std::move(*loaded);
  Result<void> opened = open_by_serial();
  if (!opened) {
    dhd_ = {};
    return opened;
  }
  ask_abilities();
  return {};
}

Result<void> ForceDimensionDevice::open_by_serial() {
  const int count = dhd_.call.available_count();
  if (count <= 0) return Error{dhd_nothing(dhd_.call), "", "", "force-dimension"};
  std::string serials;
  for (int index = 0; index < count; ++index) {
    const int id = dhd_.call.open_id(static_cast<char>(index));
    if (id < 0) continue;
    const std::string serial = dhd_serial_of(dhd_.call, static_cast<char>(id));
    if (options_.serial.empty() || serial == options_.serial) {
      id_ = id;
      info_.serial = serial;
      return {};
    }
    dhd_.call.close(static_cast<char>(id));
    serials += (serials.empty() ? "" : ", ") + serial;
  }
  if (serials.empty())
    return failure("no device of Force Dimension can be opened", "one that no program holds");
  return Error{"no device of Force Dimension has this serial", options_.serial, "one of " + serials,
               "force-dimension"};
}

void ForceDimensionDevice::ask_abilities() {
  const DhdFunctions& call = dhd_.call;
  const char id = static_cast<char>(id_);
  const DhdFamily& family = family_of(call.system_type(id));
  const char* name = call.system_name(id);
  info_.name = "force-dimension " + std::string(name == nullptr ? family.name : name);
  info_.is_hardware = true;
  info_.senses_rotation = call.has_wrist(id);
  info_.actuates_force = true;
  info_.actuates_torque = call.has_active_wrist(id) && family.max_torque_Nm > 0.0;
  info_.max_force_N = family.max_force_N;
  info_.max_torque_Nm = info_.actuates_torque ? family.max_torque_Nm : 0.0;
  info_.max_stiffness_N_per_m = family.stiffness_N_per_m;
  info_.max_stiffness_Nm_per_rad = info_.actuates_torque ? family.stiffness_Nm_per_rad : 0.0;
  info_.workspace_radius_m = family.radius_m;
  info_.handle.delay_s = kTransfer_s;
  has_gripper_ = call.has_gripper(id);
  ask_inertia();
  gate_ = CommandGate(info_);
}

/// The handle's inertia where it is now; old libraries lack the functions.
void ForceDimensionDevice::ask_inertia() {
  const DhdFunctions& call = dhd_.call;
  if (call.can_get_joint_angles == nullptr || call.can_get_inertia == nullptr ||
      call.can_enable_expert == nullptr || call.can_enable_expert() < 0)
    return;
  const char id = static_cast<char>(id_);
  double angles[8] = {}, rows[6][6] = {};
  const bool stated =
      call.can_get_joint_angles(angles, id) >= 0 && call.can_get_inertia(angles, rows, id) >= 0;
  if (call.can_disable_expert != nullptr) call.can_disable_expert();
  if (!stated) return;
  Eigen::Matrix<double, 6, 6> M;
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column < 6; ++column) M(row, column) = rows[row][column];
  const ApparentInertia least = least_apparent(M);
  info_.handle.mass_kg = least.mass_kg;
  info_.handle.inertia_kg_m2 = least.inertia_kg_m2;
}

DriverSurvey ForceDimensionDevice::survey() {
  DriverSurvey survey{"force-dimension", {}, ""};
  const Result<DhdLibrary> loaded = DhdLibrary::load();
  if (!loaded) {
    survey.nothing = loaded.error().message();
    return survey;
  }
  const DhdFunctions& call = loaded->call;
  for (int index = 0; index < call.available_count(); ++index) {
    const int id = call.open_id(static_cast<char>(index));
    if (id < 0) continue;
    const std::string serial = dhd_serial_of(call, static_cast<char>(id));
    std::array<int, dhd_status::kRoom> states{};
    std::string health;
    if (call.status(states.data(), static_cast<char>(id)) >= 0 && states[dhd_status::kReset] == 0)
      health = "not calibrated: run the SDK's HapticInit with your hands off the handle";
    call.close(static_cast<char>(id));
    const Result<std::unique_ptr<Device>> device = connect({.serial = serial});
    if (device) survey.found.push_back({"force-dimension:" + serial, (*device)->info(), health});
  }
  if (survey.found.empty()) survey.nothing = dhd_nothing(call);
  return survey;
}

/// What the library lets be set; old ones lack some of it, and the device is as safe as its maker made it.
void ForceDimensionDevice::set_limits() const {
  const DhdFunctions& call = dhd_.call;
  const char id = static_cast<char>(id_);
  if (call.can_set_max_force != nullptr) call.can_set_max_force(info_.max_force_N, id);
  if (call.can_set_max_torque != nullptr) call.can_set_max_torque(info_.max_torque_Nm, id);
  if (call.can_set_gravity_compensation != nullptr) call.can_set_gravity_compensation(1, id);
  if (call.can_set_watchdog == nullptr || call.can_enable_expert == nullptr) return;
  if (call.can_enable_expert() < 0) return;
  call.can_set_watchdog(static_cast<unsigned char>(std::lround(kWatchdog_s / kWatchdogTick_s)), id);
  if (call.can_disable_expert != nullptr) call.can_disable_expert();
}

Result<void> ForceDimensionDevice::open() {
  if (is_open_) return {};
  if (Result<void> connected = connect_once(); !connected) return connected;
  const DhdFunctions& call = dhd_.call;
  const char id = static_cast<char>(id_);
  std::array<int, dhd_status::kRoom> states{};
  if (call.status(states.data(), id) < 0) {
    const Error error = failure("the device does not tell its state", "one that is switched on");
    close();
    return error;
  }
  if (states[dhd_status::kReset] == 0) {
    close();
    return Error{
        "the device is not calibrated", "",
        "a calibration: run the SDK's HapticInit with your hands off the handle (it moves), or, on a "
        "Falcon, move the handle gently to all its ends",
        info_.name};
  }
  set_limits();
  const bool on = send({}) && call.enable_force(1, id) >= 0 && call.status(states.data(), id) >= 0 &&
                  states[dhd_status::kForce] != 0;
  if (!on) {
    Error error = failure(dhd_force_off_sentence(states[dhd_status::kForceOffCause]), "");
    close();
    return error;
  }
  if (has_gripper_ && call.can_emulate_button != nullptr) call.can_emulate_button(1, id);
  answers_ = motors_on_ = true;
  asked_ = has_delivered_ = false;
  is_open_ = true;
  Result<void> guarded = guard_.start(options_.stale_after_s, [this] { send({}); });
  if (!guarded) close();
  return guarded;
}

std::string ForceDimensionDevice::trouble() const {
  if (!answers_) return "the device does not answer: plug it in, switch it on, and start anew";
  return motors_on_ ? "" : dhd_force_off_sentence(force_off_cause_);
}

void ForceDimensionDevice::close() noexcept {
  guard_.stop();
  if (id_ >= 0) {
    const char id = static_cast<char>(id_);
    send({});
    dhd_.call.enable_force(0, id);
    dhd_.call.close(id);
  }
  id_ = -1;
  is_open_ = false;
  dhd_ = {};
}

bool ForceDimensionDevice::send(const Wrench& F_D) const noexcept {
  return dhd_.call.set_wrench(F_D.f.x(), F_D.f.y(), F_D.f.z(), F_D.t.x(), F_D.t.y(), F_D.t.z(), 0.0,
                              static_cast<char>(id_)) >= 0;
}

bool ForceDimensionDevice::write(const Wrench& F_D) noexcept {
  if (!is_open_) return false;
  Wrench sent;
  const bool finite = gate_.pass(F_D, sent);
  if (!guard_.on_time() || !finite) {
    send({});
    return false;
  }
  return send(sent);
}

bool ForceDimensionDevice::read(double now_s, DeviceSample& sample) noexcept {
  sample.valid = false;
  if (!is_open_) return false;
  const double last_s = sample.time_s;
  answers_ = read_pose(sample);
  if (!answers_) return false;
  // A pose that was read before keeps its time, so that no speed is made of it.
  sample.time_s = sample.valid ? now_s : last_s;
  read_velocity(sample);
  sample.buttons = dhd_.call.button_mask(static_cast<char>(id_));
  double grip_rad = 0.0;
  if (has_gripper_ && dhd_.call.can_get_grip != nullptr &&
      dhd_.call.can_get_grip(&grip_rad, static_cast<char>(id_)) >= 0)
    sample.grip_rad = std::abs(grip_rad);  // that of a left-handed device is negative
  ask_status(now_s);
  sample.motors_on = motors_on_;
  sample.F_D_delivered = delivered_;
  sample.has_delivered = has_delivered_;
  sample.valid = true;
  return true;
}

/// False when it fails. Sets `valid` when the pose is a new one.
bool ForceDimensionDevice::read_pose(DeviceSample& sample) noexcept {
  double x = 0.0, y = 0.0, z = 0.0;
  double frame[3][3] = {};
  const int answer = dhd_.call.position_and_frame(&x, &y, &z, frame, static_cast<char>(id_));
  if (answer < 0) return false;
  sample.X_DH.p = {x, y, z};
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) sample.X_DH.R(row, column) = frame[row][column];
  sample.valid = answer != kDhdTimeGuard;
  return true;
}

/// Just after the start the library has seen too few poses for a velocity.
void ForceDimensionDevice::read_velocity(DeviceSample& sample) const noexcept {
  const char id = static_cast<char>(id_);
  Twist& V = sample.V_DH;
  V = {};
  sample.has_velocity =
      dhd_.call.linear_velocity(&V.v.x(), &V.v.y(), &V.v.z(), id) >= 0 &&
      (!info_.senses_rotation || dhd_.call.angular_velocity(&V.w.x(), &V.w.y(), &V.w.z(), id) >= 0);
  if (!sample.has_velocity) V = {};
}

void ForceDimensionDevice::ask_status(double now_s) noexcept {
  if (asked_ && now_s - asked_s_ < kStatusEvery_s) return;
  asked_ = true;
  asked_s_ = now_s;
  const char id = static_cast<char>(id_);
  std::array<int, dhd_status::kRoom> states{};
  const bool rested = !motors_on_;  // the loop has been sending zero since the last look
  motors_on_ = dhd_.call.status(states.data(), id) >= 0 && states[dhd_status::kForce] != 0;
  if (!motors_on_) {
    force_off_cause_ = states[dhd_status::kForceOffCause];
    if (rested && force_off_cause_ == dhd_status::kCauseWatchdog && send({})) dhd_.call.enable_force(1, id);
  }
  double grip_N = 0.0;
  Wrench& F = delivered_;
  has_delivered_ =
      dhd_.call.can_get_wrench != nullptr &&
      dhd_.call.can_get_wrench(&F.f.x(), &F.f.y(), &F.f.z(), &F.t.x(), &F.t.y(), &F.t.z(), &grip_N, id) >= 0;
}

}  // namespace tactum::inline v0_1
