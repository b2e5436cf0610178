#pragma once
/// A stand-in for the library of Force Dimension, and for a device behind it. It exports the names of the
/// SDK, keeps the SDK's rules, and refuses and remembers what breaks them. The names below, found with dlsym,
/// are its back door.
///
///   forces are off until dhdEnableForce; a wrench sent meanwhile moves nothing
///   the watchdog, once set (expert mode), switches forces off when no wrench comes for so long
///   an unplugged device answers every call with -1 and a communication error

#include <array>
#include <mutex>
#include <string>
#include <vector>

namespace tactum::standin {

/// What the device measures, in its own units and axes: metres, m/s, rad/s.
struct DhdSample {
  std::array<double, 3> p{};
  std::array<double, 9> frame{1, 0, 0, 0, 1, 0, 0, 0, 1};  // row by row
  std::array<double, 3> v{};
  std::array<double, 3> w{};
  unsigned buttons = 0;
};

struct DhdDevice {
  std::mutex mutex;  // of everything below
  // What there is.
  int connected = 1;
  bool used_elsewhere = false;
  int type = 104;  // sigma.7, right-handed
  unsigned short serial = 10042;
  bool wrist = true, active_wrist = true, gripper = true;
  bool calibrated = true;
  bool refuses_force = false;  // dhdEnableForce does nothing, as with a released dead-man switch
  bool unplugged = false;
  bool old_firmware = false;         // no watchdog
  std::array<double, 36> inertia{};  // at the handle, row by row; zeros: the library knows none
  DhdSample now;
  std::vector<DhdSample> script;  // one for each read, before `now`
  double grip_rad = 0.0;
  // What happened to it.
  bool open = false;
  bool force_on = false;
  int force_off_cause = 0;
  double max_force = -1.0, max_torque = -1.0;
  double watchdog_s = 0.0;
  bool gravity_compensated = false;
  bool expert = false;
  std::size_t reads = 0;
  std::vector<std::array<double, 7>> commands;  // every wrench that was sent
  std::vector<std::string> broken_rules;
};

/// The one device of the library.
DhdDevice& dhd_device();

/// What the motors exert now: zero when forces are off, or the watchdog has run out.
std::array<double, 7> dhd_motors();

}  // namespace tactum::standin

extern "C" {
tactum::standin::DhdDevice* standin_dhd_device();
void standin_dhd_motors(double* wrench);
}
