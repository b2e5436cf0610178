#pragma once
/// Drivers with their stand-ins, for the tests that run over every driver. A rig puts its device into a pose
/// that is stated in the device's own units and axes, and states, as numbers written down by hand, what that
/// is in D.

#include <algorithm>
#include <functional>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "tactum/base/result.h"
#include "tactum/devices/device.h"

namespace tactum {

class DriverRig {
 public:
  virtual ~DriverRig() = default;
  DriverRig() = default;
  DriverRig(const DriverRig&) = delete;
  DriverRig& operator=(const DriverRig&) = delete;

  /// Makes the device by its name in the registry, or with a guard that never acts, so that a machine that
  /// is busy does not change what a test sees.
  virtual Result<std::unique_ptr<Device>> make_by_name() = 0;
  virtual Result<std::unique_ptr<Device>> make_unguarded() = 0;

  /// The device moves to its known pose, and moves on at its known velocity; then read until it is measured.
  virtual void go_to_known_pose() = 0;
  virtual Pose known_pose_in_D() const = 0;
  virtual Twist known_velocity_in_D() const = 0;
  virtual void press_button(int number, bool pressed) = 0;
  virtual void unplug() = 0;

  /// Wrenches that the device was sent since it was opened, in D and SI; and what its motors exert now.
  virtual std::vector<Wrench> commands_in_D() = 0;
  /// How many frames of the loop may lie between two commands: one, or, where the maker's library takes the
  /// newest when its own thread comes to it, as many as until the sample is stale.
  virtual int most_frames_between_commands() const { return 1; }
  virtual Wrench motors_in_D() = 0;
  /// What was done against the rules of the maker's library.
  virtual std::vector<std::string> broken_rules() = 0;
  /// Whether everything that was opened is closed, motors off.
  virtual bool is_released() = 0;

  /// What the environment is to be for a library (or daemon) that is absent; the words of the error.
  virtual std::string variable() const = 0;
  virtual std::vector<std::string> words_when_absent() const = 0;
  /// A library that lacks a function, and its name; empty for a driver without library.
  virtual std::string old_library() const { return {}; }
  virtual std::string lacking_function() const { return {}; }
};

/// A driver's name, how its rig is made, and what tells two rigs of one driver apart.
struct RigMaker {
  std::string name;
  std::function<std::unique_ptr<DriverRig>()> make;
  std::string variant = {};

  /// As the name of a test: a digit may not be the first.
  std::string test_name() const {
    std::string test = "Of_" + name + variant;
    std::replace(test.begin(), test.end(), '-', '_');
    return test;
  }

  /// In a list of tests.
  friend void PrintTo(const RigMaker& maker, std::ostream* out) { *out << maker.name << maker.variant; }
};

std::unique_ptr<DriverRig> make_force_dimension_rig();
std::unique_ptr<DriverRig> make_3d_systems_rig();
std::unique_ptr<DriverRig> make_virtuose_rig();
std::unique_ptr<DriverRig> make_haply_rig();
std::unique_ptr<DriverRig> make_spacemouse_rig();
std::unique_ptr<DriverRig> make_network_rig();
std::unique_ptr<DriverRig> make_web_network_rig();

inline std::vector<RigMaker> every_rig() {
  return {{"force-dimension", make_force_dimension_rig},
          {"3d-systems", make_3d_systems_rig},
          {"virtuose", make_virtuose_rig},
          {"haply", make_haply_rig},
          {"spacemouse", make_spacemouse_rig},
          {"network", make_network_rig},
          {"network", make_web_network_rig, "-over-web-socket"}};
}

}  // namespace tactum
