#include "tactum/drivers/registry.h"

#include <cstdio>

#include "tactum/base/nearest_word.h"
#include "tactum/devices/motion_file.h"
#include "tactum/devices/pointer_device.h"
#include "tactum/devices/replay_device.h"
#include "tactum/devices/simulated_device.h"
#include "tactum/drivers/force_dimension.h"
#include "tactum/drivers/haply.h"
#include "tactum/drivers/network_device.h"
#include "tactum/drivers/spacemouse.h"
#include "tactum/drivers/touch.h"
#include "tactum/drivers/virtuose.h"

namespace tactum::inline v0_1 {
namespace {

using MadeDevice = Result<std::unique_ptr<Device>>;

constexpr const char* kDefaultPreset = "premium-1.5-6dof";

/// A simulated device of some kind: simulated or led by a pointer.
template <class Kind>
MadeDevice make_handled(const std::string& preset, const DeviceOptions& options) {
  Result<SimulatedDeviceModel> model = simulated_device_preset(preset.empty() ? kDefaultPreset : preset);
  if (!model) return model.error();
  HandModel hand = no_hand();
  if (options.grip != hand.name) {
    Result<HandModel> grip = hand_model(options.grip);
    if (!grip) return grip.error();
    hand = *grip;
  }
  return MadeDevice(std::make_unique<Kind>(*model, hand, options.hand_motion));
}

MadeDevice make_replay(const std::string& path, const DeviceOptions& options) {
  if (path.empty()) return Error{"replay needs a file", "no file name", "replay:FILE", ""};
  Result<Motion> motion = read_motion(path);
  if (!motion) return motion.error();
  ReplaySettings settings;
  settings.at_end = options.repeat_replay ? AtEnd::kRepeat : AtEnd::kRest;
  if (options.fit_replay) *motion = fitted(*motion, settings.workspace_radius_m);
  auto played = std::make_shared<RecordedMotion>(std::move(*motion));
  return MadeDevice(std::make_unique<ReplayDevice>(path, std::move(played), settings));
}

std::vector<DeviceListing> list_simulated() {
  std::vector<DeviceListing> listings;
  for (const SimulatedDeviceModel& model : simulated_device_presets()) {
    char text[160];
    std::snprintf(text, sizeof text, "simulated: %.3g N, %.3g N m, reach %.3g m%s", model.max_force_N,
                  model.max_torque_Nm, model.workspace_radius_m,
                  model.max_torque_Nm > 0.0 ? "" : " (senses rotation, cannot turn the handle)");
    listings.push_back({"simulated:" + model.name, text});
  }
  return listings;
}

std::vector<DeviceListing> list_pointer() {
  return {{"pointer:PRESET", "a simulated device in a hand that the mouse leads, on the viewer's page"}};
}

std::vector<DeviceListing> list_replay() {
  return {{"replay:FILE", "plays a recorded hand from a motion file; nothing is felt"}};
}

MadeDevice make_force_dimension(const std::string& serial, const DeviceOptions&) {
  return ForceDimensionDevice::connect({.serial = serial});
}

std::vector<DeviceListing> list_force_dimension() {
  return {{"force-dimension:SERIAL",
           "an omega, delta, sigma, lambda or Falcon; SERIAL tells two of them apart", true}};
}

MadeDevice make_3d_systems(const std::string& name, const DeviceOptions&) {
  return TouchDevice::connect({.name = name});
}

std::vector<DeviceListing> list_3d_systems() {
  return {{"3d-systems:NAME", "a Touch, Touch X or PHANToM; NAME as in the maker's set-up program", true}};
}

MadeDevice make_spacemouse(const std::string& socket, const DeviceOptions&) {
  return SpaceMouse::connect(socket);
}

std::vector<DeviceListing> list_spacemouse() {
  return {{"spacemouse", "a SpaceMouse through spacenavd: it leads the hand, and nothing is felt", true}};
}

MadeDevice make_network(const std::string& argument, const DeviceOptions&) {
  const Result<NetworkDeviceOptions> options = network_device_options(argument);
  if (!options) return options.error();
  return NetworkDevice::connect(*options);
}

std::vector<DeviceListing> list_network() {
  return {
      {"network:PORT", "a device or simulator in another process, by the protocol of tactum_device.h", true}};
}

MadeDevice make_virtuose(const std::string& host, const DeviceOptions&) {
  return VirtuoseDevice::connect({.host = host});
}

std::vector<DeviceListing> list_virtuose() {
  return {{"virtuose:HOST#PORT", "a Virtuose of Haption; 127.0.0.1#53210 when no host is named", true}};
}

MadeDevice make_haply(const std::string& argument, const DeviceOptions&) {
  const Result<HaplyOptions> options = haply_options(argument);
  if (!options) return options.error();
  return HaplyDevice::connect(*options);
}

std::vector<DeviceListing> list_haply() {
  return {{"haply:ID",
           "an Inverse3 or Minverse of Haply, with a VerseGrip where there is one; or HOST:PORT/ID", true}};
}

/// One line per kind of device. NAME or NAME:ARGUMENT makes it.
struct Kind {
  const char* name;
  MadeDevice (*make)(const std::string& argument, const DeviceOptions& options);
  std::vector<DeviceListing> (*list)();
  DriverSurvey (*survey)();  // of a real device, else null
};

constexpr Kind kKinds[] = {
    {"simulated", make_handled<SimulatedDevice>, list_simulated, nullptr},
    {"pointer", make_handled<PointerDevice>, list_pointer, nullptr},
    {"replay", make_replay, list_replay, nullptr},
    {"force-dimension", make_force_dimension, list_force_dimension, ForceDimensionDevice::survey},
    {"3d-systems", make_3d_systems, list_3d_systems, TouchDevice::survey},
    {"virtuose", make_virtuose, list_virtuose, VirtuoseDevice::survey},
    {"haply", make_haply, list_haply, HaplyDevice::survey},
    {"spacemouse", make_spacemouse, list_spacemouse, SpaceMouse::survey},
    {"network", make_network, list_network, NetworkDevice::survey},
};

}  // namespace

std::string listed_device_name(const std::string& name) {
  for (const SimulatedDeviceModel& model : simulated_device_presets())
    if (model.name == name) return "simulated:" + name;
  return name;
}

Result<std::unique_ptr<Device>> make_device(const std::string& name, const DeviceOptions& options) {
  const std::string listed = listed_device_name(name);
  const std::size_t colon = listed.find(':');
  const std::string kind_name = listed.substr(0, colon);
  const std::string argument = colon == std::string::npos ? "" : listed.substr(colon + 1);
  for (const Kind& kind : kKinds) {
    if (kind_name == kind.name) return kind.make(argument, options);
  }
  std::vector<std::string> known{kKinds[0].name};
  std::string names = known.front();
  for (const DeviceListing& listing : list_devices()) {
    known.push_back(listing.name);
    names += ", " + listing.name;
  }
  for (const SimulatedDeviceModel& model : simulated_device_presets()) known.push_back(model.name);
  const std::string nearest = nearest_word(name, known);
  return Error{
      "unknown device", "'" + name + "'",
      nearest.empty() ? "one of " + names : "'" + listed_device_name(nearest) + "' (of " + names + ")", ""};
}

std::vector<DeviceListing> list_devices() {
  std::vector<DeviceListing> listings;
  for (const Kind& kind : kKinds) {
    for (DeviceListing& listing : kind.list()) listings.push_back(std::move(listing));
  }
  return listings;
}

std::vector<DriverSurvey> survey_drivers() {
  std::vector<DriverSurvey> surveys;
  for (const Kind& kind : kKinds)
    if (kind.survey != nullptr) surveys.push_back(kind.survey());
  return surveys;
}

}  // namespace tactum::inline v0_1
