#pragma once
/// What a driver finds when it looks around: for `tactum devices`.

#include <string>
#include <vector>

#include "tactum/devices/device.h"

namespace tactum::inline v0_1 {

/// A device that is connected.
struct FoundDevice {
  std::string name;    ///< for make_device: "force-dimension:10042"
  DeviceInfo info;     ///< as far as it can be told
  std::string health;  ///< why it is not ready, with the cure; empty: it is
};

/// A driver and what it found.
struct DriverSurvey {
  std::string driver;              ///< "force-dimension"
  std::vector<FoundDevice> found;  ///< may be empty
  std::string nothing;             ///< why nothing was found, with the cure; empty when something was
};

}  // namespace tactum::inline v0_1
