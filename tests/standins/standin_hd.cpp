#include "standins/standin_hd.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <thread>

using tactum::standin::HdDevice;

namespace {

constexpr unsigned kHandle = 7, kInvalidHandle = 0xffffffff, kDone = 0;
constexpr unsigned kInvalidOperation = 0x102, kBadHandle = 0x104, kWarmMotors = 0x200,
                   kExceededMaxForce = 0x201, kDeviceFault = 0x300, kCommunicationError = 0x302,
                   kIllegalBegin = 0x400, kIllegalEnd = 0x401, kFrameError = 0x402;
constexpr unsigned kForceOutput = 0x4000;

struct Scheduler {
  unsigned (*callback)(void*) = nullptr;
  void* data = nullptr;
  std::thread thread;
  std::atomic<bool> stop{false};
  std::mutex ticking;    // one call at a time
  bool by_hand = false;  // guarded by it: calls come from standin_hd_tick alone
};

HdDevice& device_behind() {
  static HdDevice device;
  return device;
}
Scheduler& scheduler() {
  static Scheduler the_scheduler;
  return the_scheduler;
}

/// The device, locked as long as the object lives.
struct Locked {
  HdDevice& device = device_behind();
  std::lock_guard<std::mutex> lock{device.mutex};
  HdDevice* operator->() { return &device; }

  void fail(unsigned code, const char* rule = nullptr) {
    device.errors.push_back(code);
    if (rule != nullptr) device.broken_rules.emplace_back(rule);
  }
};

void rest_of_motors(HdDevice& device) { device.motors = {}; }

void call_back() {
  Scheduler& the = scheduler();
  while (!the.stop) {
    {
      const std::lock_guard<std::mutex> one(the.ticking);
      if (!the.by_hand && the.callback(the.data) == kDone) return;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

}  // namespace

extern "C" {

struct HDErrorInfo {
  unsigned code;
  int internal;
  unsigned device;
};

HdDevice* standin_hd_device() { return &device_behind(); }

void standin_hd_tick() {
  const std::lock_guard<std::mutex> one(scheduler().ticking);
  scheduler().by_hand = true;
  scheduler().callback(scheduler().data);
}

unsigned hdInitDevice(const char* name) {
  Locked device;
  if (name == nullptr || std::strcmp(name, "Default Device") != 0 || !device->connected || device->open) {
    device.fail(device->open ? 0x301 : kDeviceFault);
    return kInvalidHandle;
  }
  device->open = true;
  return kHandle;
}

void hdDisableDevice(unsigned id) {
  Locked device;
  if (id != kHandle || !device->open) return device.fail(kBadHandle, "a device disabled that is not open");
  if (device->running) device.fail(kInvalidOperation, "a device disabled while the scheduler runs");
  device->open = device->force_output = false;
  rest_of_motors(device.device);
}

void hdMakeCurrentDevice(unsigned id) {
  Locked device;
  if (id != kHandle || !device->open) device.fail(kBadHandle, "a device made current that is not open");
}

void hdBeginFrame(unsigned id) {
  Locked device;
  if (id != kHandle || !device->open) return device.fail(kBadHandle, "a frame of a device that is not open");
  if (device->in_frame) return device.fail(kIllegalBegin, "a frame within a frame");
  device->in_frame = true;
  device->setting = {};  // what is not set in this frame is zero
}

void hdEndFrame(unsigned id) {
  Locked device;
  if (id != kHandle || !device->in_frame) return device.fail(kIllegalEnd, "the end of no frame");
  device->in_frame = false;
  if (device->unplugged) {
    rest_of_motors(device.device);
    return device.fail(kCommunicationError);
  }
  const std::array<double, 6>& F = device->setting;
  device->commands.push_back(F);
  for (const double part : F)
    if (!std::isfinite(part)) device->broken_rules.emplace_back("a wrench that is not finite");
  const bool too_strong = std::hypot(F[0], F[1], F[2]) > device->max_force_N * 1.000001;
  if (too_strong) device.fail(kExceededMaxForce, "a force beyond the device's limit");
  if (device->overheats) device.fail(kWarmMotors);
  const bool pushes = device->force_output && !too_strong && !device->overheats;
  device->motors = pushes ? F : std::array<double, 6>{};
  if (!device->six_dof) std::fill(device->motors.begin() + 3, device->motors.end(), 0.0);
}

HDErrorInfo hdGetError() {
  Locked device;
  if (device->errors.empty()) return {0, 0, 0};
  const unsigned code = device->errors.back();
  device->errors.pop_back();
  return {code, -28, kHandle};
}

const char* hdGetErrorString(unsigned code) {
  return code == kDeviceFault          ? "Device Fault"
         : code == kCommunicationError ? "Communication Error"
                                       : "Error";
}

void hdEnable(unsigned capability) {
  Locked device;
  if (capability == kForceOutput) device->force_output = true;
}
void hdDisable(unsigned capability) {
  Locked device;
  if (capability == kForceOutput) device->force_output = false;
}

void hdGetIntegerv(unsigned what, int* values) {
  Locked device;
  if (what == 0x2000) *values = device->buttons;
  if (what == 0x2553) *values = 6;
  if (what == 0x2554) *values = device->six_dof ? 6 : 3;
  if (what == 0x2555) *values = device->calibration_styles;
}

void hdGetDoublev(unsigned what, double* values) {
  Locked device;
  const auto give = [values](const auto& numbers) { std::copy(numbers.begin(), numbers.end(), values); };
  if (what == 0x2050 || what == 0x2051 || what == 0x2052 || what == 0x2053) {
    if (!device->in_frame) return device.fail(kFrameError, "measured outside a frame");
  }
  if (what == 0x2051) give(device->velocity);
  if (what == 0x2052) give(device->transform);
  if (what == 0x2053) give(device->angular_velocity);
  if (what == 0x2551) give(device->workspace);
  if (what == 0x2800 || what == 0x2801) {
    if (!device->knows_last_wrench) return device.fail(0x100);
    std::copy_n(device->motors.begin() + (what == 0x2800 ? 0 : 3), 3, values);
  }
  if (what == 0x2602) *values = 1.0;  // N/mm
  if (what == 0x2603) *values = device->max_force_N;
  if (what == 0x2622) *values = 188.0;  // mN m
}

const char* hdGetString(unsigned what) {
  Locked device;
  return what == 0x2501   ? (device->six_dof ? "PHANTOM Premium 1.5 6DOF" : "Touch")
         : what == 0x2504 ? "50812"
                          : "";
}

void hdSetDoublev(unsigned what, const double* values) {
  Locked device;
  if (!device->in_frame) return device.fail(kFrameError, "a force outside a frame");
  if (what != 0x2700 && what != 0x2701) return device.fail(0x100, "set what cannot be set");
  if (what == 0x2701 && !device->six_dof) return device.fail(0x101, "torque of a device that has none");
  std::copy(values, values + 3, device->setting.begin() + (what == 0x2700 ? 0 : 3));
}

#ifndef STANDIN_LACKS_CALIBRATION
unsigned hdCheckCalibration() {
  Locked device;
  return device->calibration;
}

void hdUpdateCalibration(unsigned style) {
  Locked device;
  ++device->calibration_updates;
  device->last_style = style;
  if (style == 1 && device->refuses_encoder_reset) return device.fail(kInvalidOperation);
  constexpr unsigned kCalibrated = 0x5000;
  device->calibration = kCalibrated;
}

#endif

unsigned long hdScheduleAsynchronous(unsigned (*callback)(void*), void* data, unsigned short) {
  Locked device;
  scheduler().callback = callback;
  scheduler().data = data;
  device->scheduled = true;
  return 1;
}

void hdUnschedule(unsigned long) {
  Locked device;
  device->scheduled = false;
}

void hdStartScheduler() {
  {
    Locked device;
    if (!device->scheduled) return device.fail(kInvalidOperation, "the scheduler started with nothing to do");
    if (device->running) return;
    device->running = true;
  }
  scheduler().stop = false;
  scheduler().by_hand = false;
  scheduler().thread = std::thread(call_back);
}

void hdStopScheduler() {
  scheduler().stop = true;
  if (scheduler().thread.joinable()) scheduler().thread.join();
  Locked device;
  device->running = false;
  rest_of_motors(device.device);
}
}
