#pragma once
/// A stand-in for libVirtuoseAPI, version 4, and for a Virtuose behind it. It exports VirtuoseAPI's names and
/// keeps its rules: the order of the start, calls that return -1 and leave a code, a thread of its own that
/// calls the periodic function about 1000 times a second, no force without power, the dead man's sensor and
/// an emergency stop that is not pressed. What breaks a rule is remembered, and refused.

#include <array>
#include <mutex>
#include <string>
#include <vector>

namespace tactum::standin {

struct VirtuoseDevice {
  std::mutex mutex;  // of everything below
  // What there is.
  bool connected = true;
  int major = 4, axes = 6;
  bool grip_sensed = true;  // the dead man's sensor
  bool operational = true;  // the emergency stop is not pressed
  bool has_force = false;   // virtGetForce answers in impedance mode, with what the object gets
  int relays_ticks = 0;     // of the loop, until the motors push after power has come
  std::array<float, 7> pose{0.5f, 0.125f, 0.25f, 0, 0, 0, 1};
  std::array<float, 6> speed{};
  std::array<int, 3> buttons{};
  // Faults.
  bool unplugged = false;    // every call fails
  bool silent = false;       // the controller sends no packets, so the loop does not call
  bool loses_power = false;  // the controller's fuse
  std::string failing;       // the name of a function that fails
  // What happened to it.
  bool open = false, indexing_set = false, step_set = false, typed = false, saturated = false;
  bool force_on = false, powered = false, running = false;
  int powered_ticks = 0;
  std::string host;
  float max_force_N = 0.0f, max_torque_Nm = 0.0f;
  int error = 0;
  std::array<float, 6> motors{};
  std::vector<std::array<float, 6>> commands;
  std::vector<std::string> broken_rules;
};

}  // namespace tactum::standin

extern "C" {
tactum::standin::VirtuoseDevice* standin_virtuose_device();
/// From the first call on the loop runs only in these calls, once each, on the caller's thread, until it is
/// stopped.
void standin_virtuose_tick();
}
