/// tactum scenes: the scenes there are.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "commands.h"
#include "tactum/scene/builtin_scenes.h"

namespace tactum {
namespace {

/// The meshes that a scene needs and that are not there, and where they come from.
void print_what_is_missing(const std::string& name) {
  const Result<SceneDescription> scene = describe_scene(name);
  if (!scene) return;
  const std::vector<std::string> files = missing_files(*scene);
  if (!files.empty())
    fmt::print("{:<16}(absent: {}; name the folder that holds them in TACTUM_DATA, see docs/real-parts.md)\n",
               "", fmt::join(files, ", "));
}

}  // namespace

void add_scenes(CLI::App& app) {
  app.add_subcommand("scenes", "List the scenes that come with the program")->callback([] {
    for (const SceneEntry& scene : list_scenes()) {
      fmt::print("{:<16}{}\n", scene.name, scene.description);
      print_what_is_missing(scene.name);
    }
  });
}

}  // namespace tactum
