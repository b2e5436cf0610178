#pragma once
/// The functions of VirtuoseAPI 4, the device library of Haption, that are used here. The declarations and
/// numbers are ours, after its documentation. All is metric and of type float: a pose is x, y, z, then the
/// quaternion qx, qy, qz, qw; twists and wrenches have their linear part first. Functions return 0, or -1,
/// and then error_code tells.

#include "tactum/drivers/vendor_library.h"

namespace tactum::inline v0_1 {

/// VirtuoseAPI's numbers.
namespace virt {
using Context = void*;
inline constexpr int kNoIndexing = 2;
inline constexpr int kImpedance = 3;
inline constexpr int kCommunicationError = 2, kTimeout = 6, kHardwareError = 11;
}  // namespace virt

struct VirtuoseFunctions {
  virt::Context (*open)(const char* host) = nullptr;  // null when it fails
  int (*close)(virt::Context) = nullptr;
  int (*error_code)(virt::Context) = nullptr;
  const char* (*error_message)(int code) = nullptr;
  int (*api_version)(int* major, int* minor) = nullptr;
  int (*device_id)(virt::Context, int* type, int* serial) = nullptr;
  int (*axis_count)(virt::Context, int* count) = nullptr;
  int (*set_indexing)(virt::Context, int mode) = nullptr;
  int (*set_force_factor)(virt::Context, float factor) = nullptr;
  int (*set_speed_factor)(virt::Context, float factor) = nullptr;
  int (*set_time_step)(virt::Context, float step_s) = nullptr;
  int (*set_base_frame)(virt::Context, float* pose) = nullptr;
  int (*set_observation_frame)(virt::Context, float* pose) = nullptr;
  int (*set_command_type)(virt::Context, int type) = nullptr;
  int (*saturate)(virt::Context, float force_N, float torque_Nm) = nullptr;
  int (*enable_force)(virt::Context, int on) = nullptr;
  int (*set_power)(virt::Context, int on) = nullptr;
  int (*get_power)(virt::Context, int* on) = nullptr;
  int (*get_pose)(virt::Context, float* pose) = nullptr;    // of the handle in the base frame
  int (*get_speed)(virt::Context, float* twist) = nullptr;  // the same
  int (*get_force)(virt::Context, float* wrench) = nullptr;
  int (*set_force)(virt::Context, float* wrench) = nullptr;
  int (*get_button)(virt::Context, int number, int* pressed) = nullptr;
  int (*get_dead_man)(virt::Context, int* grip_sensed) = nullptr;
  int (*get_emergency_stop)(virt::Context, int* operational) = nullptr;
  int (*set_periodic)(virt::Context, void (*function)(virt::Context, void*), float* period_s,
                      void* data) = nullptr;
  int (*start_loop)(virt::Context) = nullptr;
  int (*stop_loop)(virt::Context) = nullptr;
};

struct VirtuoseLibrary {
  VendorLibrary library;
  VirtuoseFunctions call;

  /// Where it is looked for: TACTUM_VIRTUOSE_LIBRARY, else the system's folders and the loader's path.
  /// Version 3 exports no function under its own name and is refused.
  static Result<VirtuoseLibrary> load();
};

}  // namespace tactum::inline v0_1
