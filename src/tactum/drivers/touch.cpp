#include "tactum/drivers/touch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>

namespace tactum::inline v0_1 {
namespace {

constexpr double kHdMillimetre_m = 0.001;
constexpr double kHdPeriod_s = 0.001;  // of the library's thread
constexpr int kMostErrors = 64;        // taken from the stack at once

/// HDAPI's axes in D: D's x is its z, D's y its x, D's z its y.
Vec3 hd_in_D(const double* v) noexcept { return {v[2], v[0], v[1]}; }
std::array<double, 3> to_hd(const Vec3& v, double unit) noexcept {
  return {v.y() * unit, v.z() * unit, v.x() * unit};
}

/// All devices share the library's one scheduler: it runs while some device is open.
std::mutex hd_scheduler_mutex;
int hd_scheduler_users = 0;

bool hd_lost_by(unsigned code) { return code >= hd::kDeviceFault && code <= hd::kTimerError; }
bool hd_motors_off_by(unsigned code) { return code >= hd::kWarmMotors && code <= hd::kForceError; }

/// The word for it in the maker's own set-up.
const char* hd_calibration_cure() {
  return "not calibrated: put the stylus into its inkwell, or, on a Premium, run the maker's diagnosis with "
         "the arm in its reset pose";
}

}  // namespace

Result<std::unique_ptr<Device>> TouchDevice::connect(const TouchOptions& options) {
  std::unique_ptr<TouchDevice> device(new TouchDevice(options));
  if (Result<void> connected = device->connect_once(); !connected) return connected.error();
  return std::unique_ptr<Device>(std::move(device));
}

Result<void> TouchDevice::connect_once() {
  if (id_ != hd::kInvalidHandle) return {};
  Result<HdLibrary> loaded = HdLibrary::load();
  if (!loaded) return loaded.error();
  hd_ = std::move(*loaded);
  // No null for the default: some versions of the library do not survive it.
  std::vector<std::string> names{options_.name};
  if (options_.name.empty()) names = {"Default Device", "Default PHANToM"};
  std::string complaint;
  for (const std::string& name : names) {
    const unsigned id = hd_.call.init_device(name.c_str());
    const HdErrorInfo error = hd_.call.get_error();
    drain_errors();
    if (error.code == 0 && id != hd::kInvalidHandle) {
      id_ = id;
      error_ = 0;
      ask_abilities();
      return {};
    }
    complaint += (complaint.empty() ? "" : "; ") + name + ": " + hd_.call.error_string(error.code);
  }
  hd_ = {};
  return Error{
      "no device of 3D Systems can be opened", complaint,
      "one that is plugged in, switched on, set up under this name in the maker's set-up program, and "
      "may be opened by you (tactum devices --install-udev, then plug it in anew)",
      "3d-systems"};
}

void TouchDevice::ask_abilities() {
  const HdFunctions& call = hd_.call;
  call.make_current(id_);
  const auto text = [&call](unsigned what) {
    const char* said = call.get_string(what);
    return std::string(said == nullptr ? "" : said);
  };
  const auto number = [&call](unsigned what) {
    double value = 0.0;
    call.get_doubles(what, &value);
    return std::isfinite(value) ? value : 0.0;
  };
  int input_dof = 0, output_dof = 0;
  call.get_integers(hd::kInputDof, &input_dof);
  call.get_integers(hd::kOutputDof, &output_dof);
  info_.name = "3d-systems " + text(hd::kModel);
  info_.serial = text(hd::kSerial);
  info_.is_hardware = true;
  info_.senses_rotation = input_dof >= 6;
  info_.actuates_force = true;
  info_.max_force_N = std::clamp(number(hd::kMaxForce), 0.5, kMostForce_N);
  // Not every version tells it in the same unit: a number that no such device has is replaced.
  constexpr double kPlausible_N_per_mm[] = {0.1, 5.0};
  constexpr double kWeak_N_per_mm = 0.4, kPer_m = 1000.0;
  const double stated = number(hd::kMaxStiffness);
  const bool plausible_stiffness = stated >= kPlausible_N_per_mm[0] && stated <= kPlausible_N_per_mm[1];
  info_.max_stiffness_N_per_m = (plausible_stiffness ? stated : kWeak_N_per_mm) * kPer_m;
  info_.actuates_torque = output_dof >= 6;
  if (info_.actuates_torque) {
    const double torque_Nm = number(hd::kMaxTorque) * kHdMillimetre_m;  // told in thousandths
    info_.max_torque_Nm = torque_Nm > 0.0 ? std::min(torque_Nm, kMostTorque_Nm) : kMostTorque_Nm;
    info_.max_stiffness_Nm_per_rad = 0.3;  // of CHAI3D's table
  }
  info_.handle.delay_s = kHdPeriod_s;
  ask_workspace();
  drain_errors();
}

void TouchDevice::ask_workspace() {
  std::array<double, 6> box{};  // least x, y, z, then greatest [mm]
  hd_.call.get_doubles(hd::kUsableWorkspace, box.data());
  const Vec3 least = hd_in_D(box.data()) * kHdMillimetre_m,
             greatest = hd_in_D(box.data() + 3) * kHdMillimetre_m;
  const Vec3 half = 0.5 * (greatest - least);
  constexpr double kSmall_m = 0.05;
  const bool stated = half.allFinite() && half.minCoeff() > 0.0 && half.maxCoeff() < 1.0;
  centre_D_ = stated ? Vec3(0.5 * (least + greatest)) : Vec3(Vec3::Zero());
  info_.workspace_radius_m = stated ? half.minCoeff() : kSmall_m;
}

DriverSurvey TouchDevice::survey() {
  DriverSurvey survey{"3d-systems", {}, ""};
  TouchDevice device(TouchOptions{});
  if (const Result<void> connected = device.connect_once(); !connected) {
    survey.nothing = connected.error().message();
    return survey;
  }
  device.calibrate();
  survey.found.push_back({"3d-systems", device.info_, device.calibrated_ ? "" : hd_calibration_cure()});
  return survey;
}

/// Inkwell where it is offered: a Premium lists the reset of its encoders as well, and refuses it. A refusal
/// is no error, the device then is as uncalibrated as before.
void TouchDevice::calibrate() noexcept {
  const HdFunctions& call = hd_.call;
  unsigned state = call.check_calibration();
  if (state == hd::kNeedsUpdate) {
    int offered = 0;
    call.get_integers(hd::kCalibrationStyle, &offered);
    const unsigned styles = static_cast<unsigned>(offered);
    call.update_calibration((styles & hd::kInkwell) != 0     ? hd::kInkwell
                            : (styles & hd::kAutomatic) != 0 ? hd::kAutomatic
                                                             : hd::kEncoderReset);
    state = call.check_calibration();
  }
  calibrated_ = state == hd::kCalibrated;
}

Result<void> TouchDevice::open() {
  if (is_open_) return {};
  if (Result<void> connected = connect_once(); !connected) return connected;
  const HdFunctions& call = hd_.call;
  call.make_current(id_);
  calibrate();
  call.enable(hd::kForceOutput);
  call.enable(hd::kMaxForceClamping);
  call.enable(hd::kSoftwareForceLimit);
  drain_errors();
  exchange_.start(CommandGate(info_), options_.stale_after_s);
  ticks_ = 0;
  has_last_wrench_ = true;
  task_ = call.schedule(on_tick, this, hd::kPriority);
  is_open_ = true;
  {
    const std::lock_guard<std::mutex> lock(hd_scheduler_mutex);
    if (hd_scheduler_users++ == 0) call.start_scheduler();
  }
  if (exchange_.served_twice()) return {};
  close();
  return Error{"the library's servo thread does not run", "no frame within a second",
               "the maker's diagnosis passed", info_.name};
}

void TouchDevice::close() noexcept {
  if (is_open_) {
    exchange_.write({});
    exchange_.served_twice();  // so that the zero is sent
    const std::lock_guard<std::mutex> lock(hd_scheduler_mutex);
    hd_.call.stop_scheduler();
    hd_.call.unschedule(task_);
    if (--hd_scheduler_users > 0) hd_.call.start_scheduler();
  }
  if (id_ != hd::kInvalidHandle) {
    hd_.call.make_current(id_);
    hd_.call.disable(hd::kForceOutput);
    hd_.call.disable_device(id_);
  }
  id_ = hd::kInvalidHandle;
  is_open_ = false;
  hd_ = {};
}

unsigned TouchDevice::on_tick(void* self) noexcept {
  static_cast<TouchDevice*>(self)->tick();
  return hd::kContinue;
}

/// On the library's thread.
void TouchDevice::tick() noexcept {
  const HdFunctions& call = hd_.call;
  call.make_current(id_);
  call.begin_frame(id_);
  DeviceSample& sample = exchange_.sample();
  measure(sample);
  push();
  call.end_frame(id_);
  const bool motors_off = hd_motors_off_by(drain_errors());
  if (++ticks_ == kTicksPerCalibrationCheck) {
    calibrate();
    ticks_ = 0;
  }
  sample.motors_on = calibrated_ && !motors_off;
  sample.has_delivered = has_last_wrench_;
  exchange_.publish();
}

void TouchDevice::measure(DeviceSample& sample) const noexcept {
  const HdFunctions& call = hd_.call;
  std::array<double, 16> X{};  // column by column, the position in millimetres
  std::array<double, 3> v{}, w{};
  int buttons = 0;
  call.get_doubles(hd::kTransform, X.data());
  call.get_doubles(hd::kVelocity, v.data());
  call.get_doubles(hd::kAngularVelocity, w.data());
  call.get_integers(hd::kButtons, &buttons);
  for (int column = 0; column < 3; ++column) {
    // D's axes are HDAPI's z, x, y, of the frame and of the handle alike.
    const int from = (column + 2) % 3;
    sample.X_DH.R.col(column) = hd_in_D(X.data() + static_cast<std::ptrdiff_t>(4 * from));
  }
  sample.X_DH.p = hd_in_D(X.data() + 12) * kHdMillimetre_m - centre_D_;
  sample.V_DH = {hd_in_D(v.data()) * kHdMillimetre_m, hd_in_D(w.data())};
  sample.has_velocity = true;
  sample.buttons = static_cast<std::uint32_t>(buttons);
  if (!has_last_wrench_) return;
  std::array<double, 3> f{}, t{};
  call.get_doubles(hd::kLastForce, f.data());
  if (info_.actuates_torque) call.get_doubles(hd::kLastTorque, t.data());
  sample.F_D_delivered = {hd_in_D(f.data()), hd_in_D(t.data()) * kHdMillimetre_m};
}

void TouchDevice::push() noexcept {
  const Wrench F = calibrated_ ? exchange_.command() : Wrench{};
  hd_.call.set_doubles(hd::kForce, to_hd(F.f, 1.0).data());
  if (info_.actuates_torque) hd_.call.set_doubles(hd::kTorque, to_hd(F.t, 1.0 / kHdMillimetre_m).data());
}

/// Empties the library's stack of errors; returns the one that matters most, or 0.
std::uint32_t TouchDevice::drain_errors() noexcept {
  std::uint32_t worst = 0;
  for (int n = 0; n < kMostErrors; ++n) {
    const HdErrorInfo error = hd_.call.get_error();
    if (error.code == 0) break;
    if (error.code == hd::kInvalidEnum) has_last_wrench_ = false;  // all else is asked of every version
    if (hd_lost_by(error.code) || hd_motors_off_by(error.code)) worst = std::max(worst, error.code);
  }
  if (worst != 0) error_ = worst;
  if (hd_lost_by(worst)) exchange_.lose();
  return worst;
}

bool TouchDevice::read(double now_s, DeviceSample& sample) noexcept {
  sample.valid = false;
  return is_open_ && exchange_.read(now_s, sample);
}

bool TouchDevice::write(const Wrench& F_D) noexcept { return is_open_ && exchange_.write(F_D); }

std::string TouchDevice::trouble() const {
  const unsigned code = error_;
  if (exchange_.lost() || hd_lost_by(code))
    return "the device does not answer: plug it in, switch it on, and start anew";
  if (hd_motors_off_by(code))
    return "the device switched its motors off: too warm, or pushed too hard or too fast; let it rest";
  return is_open_ && !calibrated_ ? hd_calibration_cure() : "";
}

}  // namespace tactum::inline v0_1
