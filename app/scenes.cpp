/// tactum scenes: the scenes there are. tactum devices: the devices there are.

#include <fmt/format.h>

#include "commands.h"
#include "tactum/devices/registry.h"
#include "tactum/haptics/coupling_gains.h"
#include "tactum/scene/builtin_scenes.h"

namespace tactum {
namespace {

constexpr double kRate_Hz = 1000.0;  // for which the couplings are listed

}  // namespace

void add_scenes(CLI::App& app) {
  app.add_subcommand("scenes", "List the scenes that come with the program")->callback([] {
    for (const SceneEntry& scene : list_scenes()) fmt::print("{:<16}{}\n", scene.name, scene.description);
  });
}

void add_devices(CLI::App& app) {
  app.add_subcommand("devices", "List the devices that can be asked for")->callback([] {
    for (const DeviceListing& listing : list_devices()) {
      fmt::print("{:<32}{}\n", listing.name, listing.description);
      const Result<std::unique_ptr<Device>> device = make_device(listing.name, {});
      if (device && (*device)->info().actuates_force)
        fmt::print("{:<32}{}\n", "",
                   margin_sentence(coupling_gains((*device)->info(), kRate_Hz).coupling, (*device)->info(),
                                   kRate_Hz));
    }
  });
}

}  // namespace tactum
