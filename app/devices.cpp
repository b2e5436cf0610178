/// tactum devices: the devices there are, simulated and connected, and the rules that let users open them.

#include <fmt/format.h>

#include <fstream>

#include "commands.h"
#include "tactum/drivers/registry.h"
#include "tactum/drivers/udev_rules.h"
#include "tactum/haptics/coupling_gains.h"
#include "tactum/session/device_profile.h"
#include "try_device.h"

namespace tactum {
namespace {

constexpr double kRate_Hz = 1000.0;  // for which the couplings are listed

struct DevicesOptions {
  bool install_udev = false;
  bool print_udev = false;
  TryOptions trial;
};

void print_margin(const DeviceInfo& info) {
  if (info.actuates_force)
    fmt::print("{:<32}{}\n", "", margin_sentence(coupling_gains(info, kRate_Hz).coupling, info, kRate_Hz));
}

/// "12 N, 0.2 N m, reach 0.075 m, senses rotation".
std::string abilities_of(const DeviceInfo& info) {
  std::string text = info.actuates_force ? fmt::format("{:.3g} N", info.max_force_N) : "pushes nothing";
  if (info.actuates_torque) text += fmt::format(", {:.3g} N m", info.max_torque_Nm);
  text += fmt::format(", reach {:.3g} m", info.workspace_radius_m);
  if (info.handle.mass_kg > 0.0) text += fmt::format(", handle of {:.3g} kg", info.handle.mass_kg);
  text += info.senses_rotation ? ", senses rotation" : ", senses no rotation";
  if (!info.rotation_fill.empty()) text += " (" + info.rotation_fill + ")";
  return text + (info.actuates_force && !info.actuates_torque ? ", cannot turn the handle" : "");
}

/// With the profile of the device, where it has one that can be used.
DeviceInfo known_info(const DeviceInfo& info) {
  if (profile_sentence(info).empty()) return info;
  const Result<DeviceProfile> profile = read_profile(profile_path(info));
  return profile ? with_profile(info, *profile) : info;
}

void print_survey(const DriverSurvey& survey) {
  if (survey.found.empty()) fmt::print("{:<32}{}\n", survey.driver, survey.nothing);
  for (const FoundDevice& found : survey.found) {
    fmt::print("{:<32}{}{}: {}\n", found.name, found.info.name,
               found.info.serial.empty() ? "" : ", serial " + found.info.serial, abilities_of(found.info));
    if (!found.health.empty()) fmt::print("{:<32}{}\n", "", found.health);
    const std::string profile = profile_sentence(found.info);
    if (!profile.empty()) fmt::print("{:<32}{}\n", "", profile);
    print_margin(known_info(found.info));
  }
}

void list_every_device() {
  fmt::print("Connected:\n");
  for (const DriverSurvey& survey : survey_drivers()) print_survey(survey);
  fmt::print("\nWithout hardware:\n");
  for (const DeviceListing& listing : list_devices()) {
    if (listing.is_hardware) continue;
    fmt::print("{:<32}{}\n", listing.name, listing.description);
    if (const Result<std::unique_ptr<Device>> device = make_device(listing.name, {}))
      print_margin((*device)->info());
  }
}

void install_udev() {
  std::ofstream file(kUdevRulesPath);
  file << udev_rules();
  file.close();
  if (!file)
    fail(
        {"the rules cannot be written", "no right to", "sudo tactum devices --install-udev", kUdevRulesPath});
  fmt::print("{} is written. Now: sudo udevadm control --reload, and plug the device in anew.\n",
             kUdevRulesPath);
}

}  // namespace

void add_devices(CLI::App& app) {
  auto options = std::make_shared<DevicesOptions>();
  CLI::App* command =
      app.add_subcommand("devices", "List the devices that are connected, and the simulated ones");
  CLI::Option* install = command->add_flag("--install-udev", options->install_udev,
                                           "Write the udev rules that let users open the devices");
  command->add_flag("--print-udev", options->print_udev, "Print those rules, and write nothing")
      ->excludes(install);
  CLI::Option* trial = command
                           ->add_option("--try", options->trial.device,
                                        "Touch this device for the first time, step by step: axes, signs, "
                                        "delay, damping (docs/devices/first-touch.md)")
                           ->excludes(install);
  command->add_flag("--yes", options->trial.yes, "Go on by itself before every step of --try")->needs(trial);
  command->add_option("--patience", options->trial.patience_s, "A step of --try waits so long for you [s]")
      ->check(number_between(0.1, 3600.0, "seconds"))
      ->needs(trial);
  command
      ->add_option("--profile", options->trial.profile,
                   "Write what --try has measured to this file, and not where tactum feel looks for it")
      ->needs(trial);
  command->callback([options] {
    if (!options->trial.device.empty())
      try_device(options->trial);
    else if (options->print_udev)
      fmt::print("# {}\n{}", kUdevRulesPath, udev_rules());
    else if (options->install_udev)
      install_udev();
    else
      list_every_device();
  });
}

}  // namespace tactum
