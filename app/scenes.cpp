/// tactum scenes: what there is to feel. tactum devices: what to feel it with.

#include <fmt/format.h>

#include "commands.h"
#include "tactum/devices/registry.h"
#include "tactum/scene/builtin_scenes.h"

namespace tactum {

void add_scenes(CLI::App& app) {
  app.add_subcommand("scenes", "List the scenes that come with the program")->callback([] {
    for (const SceneEntry& scene : list_scenes()) fmt::print("{:<16}{}\n", scene.name, scene.description);
  });
}

void add_devices(CLI::App& app) {
  app.add_subcommand("devices", "List the devices that can be asked for")->callback([] {
    for (const DeviceListing& device : list_devices())
      fmt::print("{:<32}{}\n", device.name, device.description);
  });
}

}  // namespace tactum
