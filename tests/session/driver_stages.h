#pragma once
/// Drivers with their stand-ins, moved reading by reading, for what a session makes of them.

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tactum/base/result.h"
#include "tactum/devices/device.h"

namespace tactum {

/// A wrench in a device's own units, axes and precision.
using SentWrench = std::array<double, 6>;

class DriverStage {
 public:
  virtual ~DriverStage() = default;
  DriverStage() = default;
  DriverStage(const DriverStage&) = delete;
  DriverStage& operator=(const DriverStage&) = delete;

  /// The driver, with a guard that never acts: the run is on the virtual clock.
  virtual Result<std::unique_ptr<Device>> connect() = 0;
  /// What is left of a sample when it has passed through the device's units, axes and precision.
  virtual DeviceSample passed(DeviceSample sample) const { return sample; }
  virtual SentWrench as_sent(const Wrench& F) const = 0;

  /// From the first reading on the device measures when it is told to, and remembers its commands anew.
  virtual void begin() = 0;
  /// The device measures this; the driver then reads it.
  virtual void measure(const DeviceSample& sample, double now_s) = 0;
  virtual void after_write() {}
  virtual void end() {}

  /// Every command since begin(), and how many of them come before that of the first frame.
  virtual std::vector<SentWrench> commands() = 0;
  virtual std::size_t commands_before() const { return 0; }
  virtual std::vector<std::string> broken_rules() { return {}; }
};

struct StageMaker {
  std::string name;
  std::function<std::unique_ptr<DriverStage>()> make;
};

/// Every driver that pushes.
std::vector<StageMaker> every_stage();

}  // namespace tactum
