#pragma once
/// The functions of Force Dimension's SDK that are used here, loaded from libdrd or libdhd. The declarations
/// are ours, after the SDK's documentation; `char id` is the device, and every function returns 0, or another
/// number that is not negative, when it worked.

#include <string>

#include "tactum/drivers/vendor_library.h"

namespace tactum::inline v0_1 {

/// States of a device, by their places in what dhdGetStatus tells.
namespace dhd_status {
inline constexpr int kPower = 0, kReset = 3, kForce = 5, kError = 9, kForceOffCause = 14;
inline constexpr int kCauseWatchdog = 3;  // of kForceOffCause
inline constexpr int kRoom = 32;          // more than any version of the SDK writes
}  // namespace dhd_status

inline constexpr int kDhdTimeGuard = 1;  ///< a read that returned what it had returned before
inline constexpr int kDhdErrorTimeout = 7;

/// Pointers to the functions. Those from `can_` on may be null: old libraries lack them.
struct DhdFunctions {
  int (*device_count)() = nullptr;
  int (*available_count)() = nullptr;
  int (*open_id)(char index) = nullptr;  // drdOpenID where there is one, else dhdOpenID
  int (*close)(char id) = nullptr;       // of the same library
  const char* (*system_name)(char id) = nullptr;
  int (*system_type)(char id) = nullptr;
  int (*serial_number)(unsigned short* serial, char id) = nullptr;
  bool (*has_wrist)(char id) = nullptr;
  bool (*has_active_wrist)(char id) = nullptr;
  bool (*has_gripper)(char id) = nullptr;
  int (*status)(int* states, char id) = nullptr;
  int (*enable_force)(unsigned char on, char id) = nullptr;
  int (*position_and_frame)(double* x, double* y, double* z, double frame[3][3], char id) = nullptr;
  int (*linear_velocity)(double* x, double* y, double* z, char id) = nullptr;
  int (*angular_velocity)(double* x, double* y, double* z, char id) = nullptr;
  int (*set_wrench)(double fx, double fy, double fz, double tx, double ty, double tz, double grip,
                    char id) = nullptr;
  unsigned (*button_mask)(char id) = nullptr;
  const char* (*last_error)() = nullptr;  // of the calling thread

  int (*can_get_wrench)(double*, double*, double*, double*, double*, double*, double*, char id) = nullptr;
  int (*can_get_grip)(double* angle_rad, char id) = nullptr;
  int (*can_emulate_button)(unsigned char on, char id) = nullptr;
  int (*can_set_gravity_compensation)(int on, char id) = nullptr;
  int (*can_set_max_force)(double max_N, char id) = nullptr;
  int (*can_set_max_torque)(double max_Nm, char id) = nullptr;
  int (*can_enable_expert)() = nullptr;
  int (*can_disable_expert)() = nullptr;
  int (*can_set_watchdog)(unsigned char ticks, char id) = nullptr;
  // In expert mode: the angles of the joints, and by them the inertia at the handle, forces before torques.
  int (*can_get_joint_angles)(double angles[8], char id) = nullptr;
  int (*can_get_inertia)(double angles[8], double inertia[6][6], char id) = nullptr;
};

struct DhdLibrary {
  VendorLibrary library;
  DhdFunctions call;

  /// Where it is looked for: TACTUM_FORCE_DIMENSION_LIBRARY, else the SDK's folders and the loader's path.
  static Result<DhdLibrary> load();
};

/// "forces are off: ..." with the cure, for a cause that dhdGetStatus tells.
std::string dhd_force_off_sentence(int cause);

}  // namespace tactum::inline v0_1
