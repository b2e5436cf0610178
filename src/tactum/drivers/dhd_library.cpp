#include "tactum/drivers/dhd_library.h"

namespace tactum::inline v0_1 {
namespace {

LibrarySearch dhd_search() {
  const auto below = [](const std::string& folder, const char* rest) {
    return folder.empty() ? folder : folder + rest;
  };
  constexpr const char* kBuild = "/lib/release/lin-x86_64-gcc";
  return {"Force Dimension",
          "TACTUM_FORCE_DIMENSION_LIBRARY",
          {"libdrd.so", "libdhd.so"},  // libdrd holds the functions of both
          {below(environment("FDSDK"), kBuild), below(environment("FORCEDIM_SDK"), kBuild),
           below(environment("HOME"), "/.local/lib"), "/usr/local/lib"},
          "install the Force Dimension SDK (forcedimension.com) and libusb-1.0, and set FDSDK to its folder"};
}

void require_functions(VendorLibrary& library, DhdFunctions& call) {
  library.require("dhdGetDeviceCount", call.device_count);
  library.require("dhdGetAvailableCount", call.available_count);
  library.require("dhdGetSystemName", call.system_name);
  library.require("dhdGetSystemType", call.system_type);
  library.require("dhdGetSerialNumber", call.serial_number);
  library.require("dhdHasWrist", call.has_wrist);
  library.require("dhdHasActiveWrist", call.has_active_wrist);
  library.require("dhdHasGripper", call.has_gripper);
  library.require("dhdGetStatus", call.status);
  library.require("dhdEnableForce", call.enable_force);
  library.require("dhdGetPositionAndOrientationFrame", call.position_and_frame);
  library.require("dhdGetLinearVelocity", call.linear_velocity);
  library.require("dhdGetAngularVelocityRad", call.angular_velocity);
  library.require("dhdSetForceAndTorqueAndGripperForce", call.set_wrench);
  library.require("dhdGetButtonMask", call.button_mask);
  library.require("dhdErrorGetLastStr", call.last_error);
  // What drdOpenID opened, drdClose closes.
  if (!library.find("drdOpenID", call.open_id) || !library.find("drdClose", call.close)) {
    library.require("dhdOpenID", call.open_id);
    library.require("dhdClose", call.close);
  }
}

void find_functions(const VendorLibrary& library, DhdFunctions& call) {
  library.find("dhdGetForceAndTorqueAndGripperForce", call.can_get_wrench);
  library.find("dhdGetGripperAngleRad", call.can_get_grip);
  library.find("dhdEmulateButton", call.can_emulate_button);
  library.find("dhdSetGravityCompensation", call.can_set_gravity_compensation);
  library.find("dhdSetMaxForce", call.can_set_max_force);
  library.find("dhdSetMaxTorque", call.can_set_max_torque);
  library.find("dhdEnableExpertMode", call.can_enable_expert);
  library.find("dhdDisableExpertMode", call.can_disable_expert);
  library.find("dhdSetWatchdog", call.can_set_watchdog);
  library.find("dhdGetJointAngles", call.can_get_joint_angles);
  library.find("dhdJointAnglesToInertiaMatrix", call.can_get_inertia);
}

}  // namespace

Result<DhdLibrary> DhdLibrary::load() {
  Result<VendorLibrary> loaded = VendorLibrary::load(dhd_search());
  if (!loaded) return loaded.error();
  DhdLibrary dhd{std::move(*loaded), {}};
  require_functions(dhd.library, dhd.call);
  find_functions(dhd.library, dhd.call);
  if (Result<void> whole = dhd.library.check(); !whole) return whole.error();
  return dhd;
}

std::string dhd_force_off_sentence(int cause) {
  static constexpr const char* kCauses[] = {
      "the device does not say why; press its force button",
      "its force button was pressed; press it again",
      "the handle moved too fast; press the force button, or start anew",
      "its watchdog missed the commands; start anew",
      "a program switched them off; start anew",
      "its USB connection broke; plug it in and start anew",
      "its dead-man switch is released; hold it",
  };
  constexpr int kKnown = static_cast<int>(sizeof kCauses / sizeof kCauses[0]);
  return std::string("forces are off: ") + kCauses[cause >= 0 && cause < kKnown ? cause : 0];
}

}  // namespace tactum::inline v0_1
