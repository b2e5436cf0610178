#include "standins/standin_dhd.h"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "standins/moved_handle.h"

namespace tactum::standin {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kNoError = 0, kErrorCommunication = 2, kErrorNoDevice = 5, kErrorNotAvailable = 6,
              kErrorTimeout = 7, kErrorExpertDisabled = 9, kErrorNotImplemented = 10, kErrorInvalidIndex = 15,
              kErrorInUse = 20, kErrorInvalid = 21;
constexpr int kCauseWatchdog = 3, kCauseSoftware = 4, kCauseDeadMan = 6;
constexpr double kPi = 3.14159265358979323846;

thread_local int last_error = kNoError;
Clock::time_point last_command;
const Clock::time_point kStart = Clock::now();

int fail(int error) {
  last_error = error;
  return -1;
}

/// With the mutex held: whether a call about device `id` can be answered.
bool answers(DhdDevice& device, char id) {
  if (id != 0 || !device.open) {
    device.broken_rules.emplace_back("a call for a device that is not open");
    last_error = kErrorInvalid;
    return false;
  }
  last_error = device.unplugged ? kErrorCommunication : kNoError;
  return !device.unplugged;
}

void look_at_watchdog(DhdDevice& device) {
  if (!device.force_on || device.watchdog_s <= 0.0) return;
  if (std::chrono::duration<double>(Clock::now() - last_command).count() < device.watchdog_s) return;
  device.force_on = false;
  device.force_off_cause = kCauseWatchdog;
}

/// TACTUM_STANDIN_SWEEP: a hand that goes to and fro, in real time, for programs that are run as a whole.
DhdSample swept() {
  const double t = std::chrono::duration<double>(Clock::now() - kStart).count();
  DhdSample sample;
  constexpr double kRange_m = 0.03, kTurn_rad = 0.5, kRate = 2.0 * kPi;
  const double angle = kTurn_rad * std::sin(kRate * t);
  sample.p[0] = kRange_m * std::sin(kRate * t);
  sample.v[0] = kRange_m * kRate * std::cos(kRate * t);
  sample.w[2] = kTurn_rad * kRate * std::cos(kRate * t);
  sample.frame = {std::cos(angle), -std::sin(angle), 0, std::sin(angle), std::cos(angle), 0, 0, 0, 1};
  return sample;
}

/// TACTUM_STANDIN_RECORD names a file: every wrench that was sent, a line each, when the device is closed.
void write_record(const DhdDevice& device) {
  const char* path = std::getenv("TACTUM_STANDIN_RECORD");
  if (path == nullptr) return;
  std::FILE* file = std::fopen(path, "w");
  if (file == nullptr) return;
  for (const auto& F : device.commands)
    std::fprintf(file, "%.17g %.17g %.17g %.17g %.17g %.17g\n", F[0], F[1], F[2], F[3], F[4], F[5]);
  std::fprintf(file, "forces %s at the end, %zu rules broken\n", device.force_on ? "on" : "off",
               device.broken_rules.size());
  std::fclose(file);
}

/// Scales three numbers down to `limit`, where there is one.
void clamp_length(double* v, double limit) {
  const double length = std::hypot(v[0], v[1], v[2]);
  if (limit < 0.0 || length <= limit) return;
  for (int i = 0; i < 3; ++i) v[i] *= limit / length;
}

/// With the mutex held: what the motors exert now.
std::array<double, 7> exerted(DhdDevice& device) {
  look_at_watchdog(device);
  if (!device.force_on || device.commands.empty()) return {};
  std::array<double, 7> wrench = device.commands.back();
  clamp_length(wrench.data(), device.max_force);
  clamp_length(wrench.data() + 3, device.max_torque);
  return wrench;
}

/// TACTUM_STANDIN_HAND names a file by which a test in another process leads the hand at the handle; the
/// handle then moves under the motors, too. With the mutex held.
void move_handle(DhdDevice& device) {
  const char* path = std::getenv("TACTUM_STANDIN_HAND");
  if (path == nullptr) return;
  static AskedHand hand(path);
  static MovedHandle handle;
  if (!hand.is_mapped()) return;
  handle.advance(exerted(device).data());
  hand.pass_on(handle);
  for (std::size_t i = 0; i < 3; ++i) {
    device.now.p[i] = handle.x[i];
    device.now.v[i] = handle.u[i];
    device.now.w[i] = handle.u[i + 3];
  }
  device.now.frame = handle.frame();
}

}  // namespace

DhdDevice& dhd_device() {
  static DhdDevice device;
  return device;
}

std::array<double, 7> dhd_motors() {
  DhdDevice& device = dhd_device();
  const std::lock_guard<std::mutex> lock(device.mutex);
  return exerted(device);
}

}  // namespace tactum::standin

using namespace tactum::standin;

/// The device, locked as long as the object lives.
struct Locked {
  DhdDevice& device = dhd_device();
  std::lock_guard<std::mutex> lock{device.mutex};
  DhdDevice* operator->() { return &device; }
};

extern "C" {

DhdDevice* standin_dhd_device() { return &dhd_device(); }
void standin_dhd_motors(double* wrench) {
  const std::array<double, 7> now = dhd_motors();
  for (std::size_t i = 0; i < now.size(); ++i) wrench[i] = now[i];
}

int dhdGetDeviceCount() {
  Locked device;
  return device->unplugged ? 0 : device->connected;
}

int dhdGetAvailableCount() {
  Locked device;
  return device->unplugged || device->used_elsewhere || device->open ? 0 : device->connected;
}

int drdOpenID(char index) {
  Locked device;
  if (index < 0 || index >= device->connected) return fail(kErrorInvalidIndex);
  if (device->unplugged) return fail(kErrorNoDevice);
  if (device->used_elsewhere || device->open) return fail(kErrorInUse);
  device->open = true;
  device->force_on = device->expert = false;
  return 0;
}

int drdClose(char id) {
  Locked device;
  if (id != 0 || !device->open) {
    device->broken_rules.emplace_back("a device closed that is not open");
    return fail(kErrorInvalid);
  }
  if (device->force_on) device->broken_rules.emplace_back("closed with forces on");
  device->open = device->force_on = false;
  write_record(device.device);
  return 0;
}

const char* dhdGetSystemName(char id) {
  Locked device;
  return id == 0 && device->open ? "sigma.7" : nullptr;
}
int dhdGetSystemType(char id) {
  Locked device;
  return answers(device.device, id) ? device->type : -1;
}
int dhdGetSerialNumber(unsigned short* serial, char id) {
  Locked device;
  if (!answers(device.device, id)) return -1;
  *serial = device->serial;
  return 0;
}
bool dhdHasWrist(char id) {
  Locked device;
  return answers(device.device, id) && device->wrist;
}
bool dhdHasActiveWrist(char id) {
  Locked device;
  return answers(device.device, id) && device->active_wrist;
}
bool dhdHasGripper(char id) {
  Locked device;
  return answers(device.device, id) && device->gripper;
}

int dhdGetStatus(int* states, char id) {
  Locked device;
  if (!answers(device.device, id)) return -1;
  look_at_watchdog(device.device);
  for (int i = 0; i < 17; ++i) states[i] = 0;
  states[0] = states[1] = states[2] = 1;
  states[3] = device->calibrated ? 1 : 0;
  states[5] = device->force_on ? 1 : 0;
  states[6] = device->force_on ? 0 : 1;
  states[14] = device->force_off_cause;
  return 0;
}

int dhdEnableForce(unsigned char on, char id) {
  Locked device;
  if (!answers(device.device, id)) return -1;
  if (on != 0 && device->commands.empty())
    device->broken_rules.emplace_back("forces on before a zero wrench");
  if (on != 0 && device->refuses_force) {
    device->force_off_cause = kCauseDeadMan;
    return 0;
  }
  device->force_on = on != 0;
  device->force_off_cause = on != 0 ? 0 : kCauseSoftware;
  last_command = Clock::now();
  return 0;
}

int dhdGetPositionAndOrientationFrame(double* x, double* y, double* z, double frame[3][3], char id) {
  Locked device;
  if (!answers(device.device, id)) return -1;
  if (device->reads < device->script.size()) device->now = device->script[device->reads];
  if (std::getenv("TACTUM_STANDIN_SWEEP") != nullptr) device->now = swept();
  move_handle(device.device);
  ++device->reads;
  *x = device->now.p[0];
  *y = device->now.p[1];
  *z = device->now.p[2];
  for (std::size_t i = 0; i < 9; ++i) frame[i / 3][i % 3] = device->now.frame[i];
  return 0;
}

/// The velocity is a difference of poses: there is none before the second read.
int dhdGetLinearVelocity(double* x, double* y, double* z, char id) {
  Locked device;
  if (!answers(device.device, id)) return -1;
  if (device->reads < 2) return fail(kErrorTimeout);
  *x = device->now.v[0];
  *y = device->now.v[1];
  *z = device->now.v[2];
  return 0;
}
int dhdGetAngularVelocityRad(double* x, double* y, double* z, char id) {
  Locked device;
  if (!answers(device.device, id)) return -1;
  if (!device->wrist) return fail(kErrorNotAvailable);
  if (device->reads < 2) return fail(kErrorTimeout);
  *x = device->now.w[0];
  *y = device->now.w[1];
  *z = device->now.w[2];
  return 0;
}

unsigned dhdGetButtonMask(char id) {
  Locked device;
  return answers(device.device, id) ? device->now.buttons : 0;
}
int dhdGetGripperAngleRad(double* angle, char id) {
  Locked device;
  if (!answers(device.device, id)) return -1;
  if (!device->gripper) return fail(kErrorNotAvailable);
  *angle = device->grip_rad;
  return 0;
}
int dhdEmulateButton(unsigned char, char id) {
  Locked device;
  if (!answers(device.device, id)) return -1;
  if (!device->force_on) device->broken_rules.emplace_back("the gripper is no button while forces are off");
  return 0;
}

#ifndef STANDIN_LACKS_WRENCH
int dhdSetForceAndTorqueAndGripperForce(double fx, double fy, double fz, double tx, double ty, double tz,
                                        double grip, char id) {
  Locked device;
  if (!answers(device.device, id)) return -1;
  const std::array<double, 7> wrench{fx, fy, fz, tx, ty, tz, grip};
  for (const double part : wrench)
    if (!std::isfinite(part)) {
      device->broken_rules.emplace_back("a wrench that is not finite");
      return fail(kErrorInvalid);
    }
  move_handle(device.device);
  look_at_watchdog(device.device);
  device->commands.push_back(wrench);
  last_command = Clock::now();
  return 0;
}
#endif

int dhdGetForceAndTorqueAndGripperForce(double* fx, double* fy, double* fz, double* tx, double* ty,
                                        double* tz, double* grip, char id) {
  {
    Locked device;
    if (!answers(device.device, id)) return -1;
  }
  const std::array<double, 7> wrench = dhd_motors();
  double* const parts[] = {fx, fy, fz, tx, ty, tz, grip};
  for (std::size_t i = 0; i < 7; ++i) *parts[i] = wrench[i];
  return 0;
}

int dhdSetGravityCompensation(int on, char id) {
  Locked device;
  if (!answers(device.device, id)) return -1;
  device->gravity_compensated = on != 0;
  return 0;
}
int dhdSetMaxForce(double limit, char id) {
  Locked device;
  if (!answers(device.device, id)) return -1;
  device->max_force = limit;
  return 0;
}
int dhdSetMaxTorque(double limit, char id) {
  Locked device;
  if (!answers(device.device, id)) return -1;
  device->max_torque = limit;
  return 0;
}
int dhdEnableExpertMode() {
  Locked device;
  device->expert = true;
  return 0;
}
int dhdDisableExpertMode() {
  Locked device;
  device->expert = false;
  return 0;
}
int dhdGetJointAngles(double* angles, char id) {
  Locked device;
  if (!answers(device.device, id)) return -1;
  for (int i = 0; i < 8; ++i) angles[i] = 0.1 * i;
  return 0;
}
int dhdJointAnglesToInertiaMatrix(double* angles, double inertia[6][6], char id) {
  Locked device;
  if (!answers(device.device, id)) return -1;
  if (!device->expert) return fail(kErrorExpertDisabled);
  if (angles[7] != 0.1 * 7) device->broken_rules.emplace_back("an inertia at angles that are none");
  if (device->inertia[0] == 0.0) return fail(kErrorNotImplemented);
  for (std::size_t i = 0; i < 36; ++i) inertia[i / 6][i % 6] = device->inertia[i];
  return 0;
}
int dhdSetWatchdog(unsigned char ticks, char id) {
  Locked device;
  if (!answers(device.device, id)) return -1;
  if (!device->expert) return fail(kErrorExpertDisabled);
  if (device->old_firmware) return fail(kErrorNotImplemented);
  constexpr double kTick_s = 125.0e-6;
  device->watchdog_s = ticks * kTick_s;
  return 0;
}

const char* dhdErrorGetLastStr() {
  switch (last_error) {
    case kNoError:
      return "no error";
    case kErrorCommunication:
      return "communication error";
    case kErrorNoDevice:
      return "no device";
    case kErrorInUse:
      return "device in use";
    case kErrorExpertDisabled:
      return "expert mode disabled";
    default:
      return "error";
  }
}
}
