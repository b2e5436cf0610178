#pragma once
/// The devices by name, from one explicit table:
///
///   simulated            the premium-1.5-6dof preset
///   simulated:PRESET     a preset of simulated_device.h; PRESET alone is the same
///   pointer:PRESET       the same in a hand that is led from outside (pointer_device.h)
///   replay:FILE          a motion file (motion_file.h)
///   force-dimension      an omega, delta, sigma, lambda or Falcon (force_dimension.h); or :SERIAL
///   3d-systems           a Touch, Touch X or PHANToM (touch.h); :NAME as in the maker's set-up program
///   network              a device in another process (network_device.h); :PORT or :ADDRESS:PORT of ours
///   virtuose             a Virtuose of Haption (virtuose.h); :HOST#PORT of its controller
///   haply                an Inverse3 or Minverse of Haply (haply.h); :ID, :HOST:PORT or :HOST:PORT/ID
///   spacemouse           a SpaceMouse through spacenavd (spacemouse.h); :SOCKET names the daemon's socket
///
/// Simulated devices are made at once. Real ones are connected when they are made, with no motor on, since
/// what they can is asked of them; Device::open switches the motors on.

#include <memory>
#include <string>
#include <vector>

#include "tactum/devices/device.h"
#include "tactum/devices/hand_motion.h"
#include "tactum/drivers/survey.h"

namespace tactum::inline v0_1 {

/// Parameters of a device beside its name. Real devices ignore the hand.
struct DeviceOptions {
  std::shared_ptr<const HandMotion> hand_motion;  ///< of the simulated hand; null: it rests at the origin
  std::string grip = "medium";                    ///< of the simulated hand; "none" for a free handle
  bool repeat_replay = false;                     ///< replay starts again at its end
  bool fit_replay = false;  ///< replay is scaled into the workspace (motion_file.h, fitted)
};

struct DeviceListing {
  std::string name;          ///< for make_device
  std::string description;   ///< one line
  bool is_hardware = false;  ///< to be found in the survey, if it is connected
};

/// The name as it is listed: "simulated:touch" of "touch"; other names as they are.
std::string listed_device_name(const std::string& name);

/// Makes a device, not yet open. The error for an unknown name gives the nearest and lists the known names.
Result<std::unique_ptr<Device>> make_device(const std::string& name, const DeviceOptions& options);

std::vector<DeviceListing> list_devices();

/// Asks every driver of real devices what is connected. Slow: loads libraries and opens devices, motors off.
std::vector<DriverSurvey> survey_drivers();

}  // namespace tactum::inline v0_1
