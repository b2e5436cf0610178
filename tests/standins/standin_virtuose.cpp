#include "standins/standin_virtuose.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <thread>

using tactum::standin::VirtuoseDevice;

namespace {

using Context = void*;
constexpr int kCommunication = 2, kWrongMode = 17, kWrongCall = 22;

struct Loop {
  void (*function)(Context, void*) = nullptr;
  void* data = nullptr;
  std::thread thread;
  std::atomic<bool> stop{false};
  std::mutex ticking;  // one tick at a time
  bool by_hand = false;
};

VirtuoseDevice& device_behind() {
  static VirtuoseDevice device;
  return device;
}
Loop& loop() {
  static Loop the_loop;
  return the_loop;
}

/// The device, locked for one call of a function of the library.
class Call {
 public:
  Call(const char* name, const void* context) {
    answers_ = context == &device && device.open && !device.unplugged && device.failing != name;
    if (context != &device || !device.open) break_rule(std::string(name) + " without a connection");
    if (!answers_) device.error = kCommunication;
  }
  /// A rule of the library; false, and the call is refused, when it is broken.
  bool holds(bool kept, const std::string& rule) {
    if (!kept) break_rule(rule);
    return kept;
  }
  int refuse(int code) {
    device.error = code;
    return -1;
  }
  bool answers() const { return answers_; }
  VirtuoseDevice* operator->() { return &device; }

  VirtuoseDevice& device = device_behind();

 private:
  void break_rule(const std::string& rule) {
    device.broken_rules.push_back(rule);
    device.error = kWrongCall;
    answers_ = false;
  }
  std::lock_guard<std::mutex> lock_{device.mutex};
  bool answers_ = false;
};

/// Does it, when the call is answered and the rule is kept.
template <class Action>
int when(Call& call, bool kept, const char* rule, Action action) {
  if (!call.answers() || !call.holds(kept, rule)) return -1;
  action();
  return 0;
}

bool pushes(const VirtuoseDevice& device) {
  return device.force_on && device.powered && device.grip_sensed && device.operational && device.running &&
         !device.unplugged && device.powered_ticks >= device.relays_ticks;
}

void tick() {
  bool silent = false;
  {
    VirtuoseDevice& device = device_behind();
    const std::lock_guard<std::mutex> lock(device.mutex);
    if (!device.operational || device.loses_power) device.powered = false;
    device.powered_ticks = device.powered ? device.powered_ticks + 1 : 0;
    if (!pushes(device)) device.motors = {};
    silent = device.silent;
    if (silent) device.motors = {};
  }
  if (!silent) loop().function(&device_behind(), loop().data);
}

void run() {
  while (!loop().stop) {
    {
      const std::lock_guard<std::mutex> one(loop().ticking);
      if (!loop().by_hand) tick();
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

bool identity(const float* pose) {
  constexpr float kIdentity[7] = {0, 0, 0, 0, 0, 0, 1};
  return std::equal(pose, pose + 7, kIdentity);
}

}  // namespace

extern "C" {

VirtuoseDevice* standin_virtuose_device() { return &device_behind(); }

void standin_virtuose_tick() {
  const std::lock_guard<std::mutex> one(loop().ticking);
  loop().by_hand = true;
  tick();
}

int virtAPIVersion(int* major, int* minor) {
  *major = device_behind().major;
  *minor = 4;
  return 0;
}

Context virtOpen(const char* host) {
  VirtuoseDevice& device = device_behind();
  const std::lock_guard<std::mutex> lock(device.mutex);
  if (device.open) device.broken_rules.emplace_back("opened while it is open");
  if (!device.connected || device.open || std::strchr(host, '#') == nullptr) {
    device.error = kCommunication;
    return nullptr;
  }
  device.host = host;
  device.open = true;
  device.indexing_set = device.step_set = device.typed = device.saturated = false;
  return &device;
}

int virtClose(Context context) {
  Call call("virtClose", context);
  if (!call->open) return -1;
  call.holds(!call->running, "closed while the loop runs");
  call.holds(!call->powered || call->unplugged, "closed with power on");
  call->open = false;
  return 0;
}

int virtGetErrorCode(Context) {
  VirtuoseDevice& device = device_behind();
  const std::lock_guard<std::mutex> lock(device.mutex);
  return device.error;
}
const char* virtGetErrorMessage(int code) {
  return code == kCommunication ? "communication error" : code == kWrongMode ? "wrong mode" : "error";
}

int virtGetDeviceID(Context context, int* type, int* serial) {
  Call call("virtGetDeviceID", context);
  return when(call, true, "", [&] {
    *type = 3;
    *serial = 871;
  });
}
int virtGetNbAxes(Context context, int* count) {
  Call call("virtGetNbAxes", context);
  return when(call, true, "", [&] { *count = call->axes; });
}

int virtSetIndexingMode(Context context, int mode) {
  Call call("virtSetIndexingMode", context);
  return when(call, !call->typed && mode == 2, "indexing on, or set after the command type",
              [&] { call->indexing_set = true; });
}
int virtSetForceFactor(Context context, float factor) {
  Call call("virtSetForceFactor", context);
  return when(call, !call->typed && factor == 1.0f, "a force factor that is not one, or set too late", [] {});
}
int virtSetSpeedFactor(Context context, float factor) {
  Call call("virtSetSpeedFactor", context);
  return when(call, !call->typed && factor == 1.0f, "a speed factor that is not one, or set too late", [] {});
}
int virtSetTimeStep(Context context, float step_s) {
  Call call("virtSetTimeStep", context);
  return when(call, !call->typed && step_s == 0.001f, "another time step, or set after the command type",
              [&] { call->step_set = true; });
}
int virtSetBaseFrame(Context context, float* pose) {
  Call call("virtSetBaseFrame", context);
  return when(call, !call->typed && identity(pose), "another base frame, or set too late", [] {});
}
int virtSetObservationFrame(Context context, float* pose) {
  Call call("virtSetObservationFrame", context);
  return when(call, !call->typed && identity(pose), "another observation frame, or set too late", [] {});
}
int virtSetCommandType(Context context, int type) {
  Call call("virtSetCommandType", context);
  return when(call, type == 3 && call->step_set && call->indexing_set,
              "a command type that is not impedance, or set before the time step and the indexing",
              [&] { call->typed = true; });
}
int virtSaturateTorque(Context context, float force_N, float torque_Nm) {
  Call call("virtSaturateTorque", context);
  return when(call, call->typed, "limits before the command type", [&] {
    call->saturated = true;
    call->max_force_N = force_N;
    call->max_torque_Nm = torque_Nm;
  });
}
int virtEnableForceFeedback(Context context, int on) {
  Call call("virtEnableForceFeedback", context);
  return when(call, on == 0 || call->saturated, "force on without limits", [&] { call->force_on = on != 0; });
}
int virtSetPowerOn(Context context, int on) {
  Call call("virtSetPowerOn", context);
  const auto zero = [](float part) { return part == 0.0f; };
  const bool rests =
      call->commands.empty() || std::all_of(call->commands.back().begin(), call->commands.back().end(), zero);
  return when(call, on != 0 ? call->force_on && call->saturated : !call->running && rests,
              "power before force and limits, or off while the loop runs or with a wrench", [&] {
                call->powered = on != 0 && call->operational;
                call->powered_ticks = 0;
              });
}
int virtGetPowerOn(Context context, int* on) {
  Call call("virtGetPowerOn", context);
  return when(call, true, "", [&] { *on = call->powered ? 1 : 0; });
}

#ifndef STANDIN_LACKS_PHYSICAL
int virtGetPhysicalPosition(Context context, float* pose) {
  Call call("virtGetPhysicalPosition", context);
  return when(call, true, "", [&] { std::copy(call->pose.begin(), call->pose.end(), pose); });
}
int virtGetPhysicalSpeed(Context context, float* speed) {
  Call call("virtGetPhysicalSpeed", context);
  return when(call, true, "", [&] { std::copy(call->speed.begin(), call->speed.end(), speed); });
}
#endif

int virtGetForce(Context context, float* wrench) {
  Call call("virtGetForce", context);
  if (call.answers() && !call->has_force) return call.refuse(kWrongMode);
  return when(call, true, "", [&] {
    std::transform(call->motors.begin(), call->motors.end(), wrench, [](float part) { return -part; });
  });
}

int virtSetForce(Context context, float* wrench) {
  Call call("virtSetForce", context);
  if (!call.answers()) return -1;
  std::array<float, 6> F{};
  std::copy(wrench, wrench + 6, F.begin());
  const bool finite = std::all_of(F.begin(), F.end(), [](float part) { return std::isfinite(part); });
  const bool zero = std::all_of(F.begin(), F.end(), [](float part) { return part == 0.0f; });
  if (!call.holds(finite, "a wrench that is not finite")) return -1;
  const bool relays_closed = call->powered && call->powered_ticks >= call->relays_ticks;
  if (!call.holds(zero || relays_closed, "a wrench before the relays are closed")) return -1;
  call.holds(std::hypot(F[0], F[1], F[2]) <= call->max_force_N &&
                 std::hypot(F[3], F[4], F[5]) <= call->max_torque_Nm,
             "a wrench beyond the limits");
  call->commands.push_back(F);
  call->motors = pushes(call.device) ? F : std::array<float, 6>{};
  return 0;
}

int virtGetButton(Context context, int number, int* pressed) {
  Call call("virtGetButton", context);
  return when(call, number >= 0 && number < 3, "a button that it does not have",
              [&] { *pressed = call->buttons[static_cast<std::size_t>(number)]; });
}
int virtGetDeadMan(Context context, int* grip_sensed) {
  Call call("virtGetDeadMan", context);
  return when(call, true, "", [&] { *grip_sensed = call->grip_sensed ? 1 : 0; });
}
int virtGetEmergencyStop(Context context, int* operational) {
  Call call("virtGetEmergencyStop", context);
  return when(call, true, "", [&] { *operational = call->operational ? 1 : 0; });
}

int virtSetPeriodicFunction(Context context, void (*function)(Context, void*), float* period_s, void* data) {
  Call call("virtSetPeriodicFunction", context);
  return when(call, call->typed && *period_s == 0.001f, "a periodic function before the command type", [&] {
    loop().function = function;
    loop().data = data;
  });
}
int virtStartLoop(Context context) {
  {
    Call call("virtStartLoop", context);
    if (!call.answers() || !call.holds(loop().function != nullptr && !call->running, "a loop of nothing"))
      return -1;
    call->running = true;
  }
  loop().stop = false;
  loop().by_hand = false;
  loop().thread = std::thread(run);
  return 0;
}
int virtStopLoop(Context context) {
  {
    Call call("virtStopLoop", context);
    call.holds(call->running, "no loop runs");
  }
  loop().stop = true;
  if (loop().thread.joinable()) loop().thread.join();
  VirtuoseDevice& device = device_behind();
  const std::lock_guard<std::mutex> lock(device.mutex);
  device.running = false;
  device.motors = {};
  return device.unplugged ? -1 : 0;
}
}
