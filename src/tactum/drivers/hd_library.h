#pragma once
/// The functions of HDAPI, the device library of 3D Systems' OpenHaptics, that are used here, loaded from
/// libHD. The declarations and numbers are ours, after its documentation. Lengths are millimetres, torques
/// thousandths of a newton metre, matrices column by column; x is right, y up, z toward the user.

#include "tactum/drivers/vendor_library.h"

namespace tactum::inline v0_1 {

struct HdErrorInfo {
  unsigned code = 0;
  int internal = 0;
  unsigned device = 0;
};

/// HDAPI's numbers.
namespace hd {
inline constexpr unsigned kInvalidHandle = 0xffffffff;
inline constexpr unsigned kContinue = 1;  // a callback's answer: call me again
inline constexpr unsigned short kPriority = 32767;
inline constexpr unsigned kButtons = 0x2000, kVelocity = 0x2051, kTransform = 0x2052,
                          kAngularVelocity = 0x2053;
inline constexpr unsigned kModel = 0x2501, kSerial = 0x2504;
inline constexpr unsigned kUsableWorkspace = 0x2551, kInputDof = 0x2553, kOutputDof = 0x2554;
inline constexpr unsigned kCalibrationStyle = 0x2555;
inline constexpr unsigned kMaxStiffness = 0x2602, kMaxForce = 0x2603, kMaxTorque = 0x2622;
inline constexpr unsigned kForce = 0x2700, kTorque = 0x2701;
inline constexpr unsigned kLastForce = 0x2800, kLastTorque = 0x2801;  // of the frame before
inline constexpr unsigned kInvalidEnum = 0x100;  // an error: the library does not know what was asked for
inline constexpr unsigned kForceOutput = 0x4000, kMaxForceClamping = 0x4001, kSoftwareForceLimit = 0x4003;
inline constexpr unsigned kCalibrated = 0x5000, kNeedsUpdate = 0x5001, kNeedsManualInput = 0x5002;
inline constexpr unsigned kEncoderReset = 1, kAutomatic = 2, kInkwell = 4;
inline constexpr unsigned kWarmMotors = 0x200, kForceError = 0x204;  // and those between: amplifiers go off
inline constexpr unsigned kDeviceFault = 0x300, kAlreadyInitiated = 0x301, kTimerError = 0x304;
}  // namespace hd

struct HdFunctions {
  unsigned (*init_device)(const char* name) = nullptr;
  void (*disable_device)(unsigned device) = nullptr;
  void (*make_current)(unsigned device) = nullptr;
  void (*begin_frame)(unsigned device) = nullptr;
  void (*end_frame)(unsigned device) = nullptr;
  HdErrorInfo (*get_error)() = nullptr;  // takes it off a stack
  const char* (*error_string)(unsigned code) = nullptr;
  void (*enable)(unsigned capability) = nullptr;
  void (*disable)(unsigned capability) = nullptr;
  void (*get_integers)(unsigned what, int* values) = nullptr;
  void (*get_doubles)(unsigned what, double* values) = nullptr;
  const char* (*get_string)(unsigned what) = nullptr;
  void (*set_doubles)(unsigned what, const double* values) = nullptr;
  unsigned (*check_calibration)() = nullptr;
  void (*update_calibration)(unsigned style) = nullptr;
  void (*start_scheduler)() = nullptr;
  void (*stop_scheduler)() = nullptr;
  unsigned long (*schedule)(unsigned (*callback)(void*), void* data, unsigned short priority) = nullptr;
  void (*unschedule)(unsigned long task) = nullptr;
};

struct HdLibrary {
  VendorLibrary library;
  HdFunctions call;

  /// Where it is looked for: TACTUM_OPENHAPTICS_LIBRARY, else OpenHaptics' folders and the loader's path.
  static Result<HdLibrary> load();
};

}  // namespace tactum::inline v0_1
