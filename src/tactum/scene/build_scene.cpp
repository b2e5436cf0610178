#include "tactum/scene/build_scene.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "tactum/scene/check_description.h"
#include "tactum/scene/scene_builder.h"

namespace tactum::inline v0_1 {

std::optional<std::string> SceneBuilder::find_file(const std::string& path, const char* kind,
                                                   const std::string& name) {
  namespace fs = std::filesystem;
  const std::vector<std::string> only{""};
  std::vector<std::string> tried;
  for (const std::string& folder : fs::path(name).is_absolute() ? only : description_.source.folders) {
    std::error_code ignored;
    tried.push_back((fs::path(folder) / name).string());
    if (fs::is_regular_file(tried.back(), ignored)) return tried.back();
  }
  fail(path, fmt::format("cannot find the {} \"{}\"", kind, name),
       tried.empty() ? "no folder to look in" : fmt::format("no file {}", fmt::join(tried, ", nor ")),
       std::string("the file ") + (description_.source.folders.empty() ? "" : "beside the scene file or ") +
           "in a folder named by TACTUM_DATA (colons between" +
           (std::getenv("TACTUM_DATA") == nullptr ? "; it is not set)" : ")"));
  return {};
}

int SceneBuilder::find_body(const std::string& path, const std::string& name, const World& world) {
  std::vector<std::string> names;
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    names.push_back(world.bodies[b].name);
    if (names.back() == name) return static_cast<int>(b);
  }
  const std::string nearest = nearest_word(name, names);
  const std::size_t dot = path.rfind('.');
  fail(
      path,
      fmt::format("no body of this name, in {}", section(path.substr(0, dot == std::string::npos ? 0 : dot))),
      fmt::format("\"{}\"", name),
      nearest.empty() ? "the name of a [[body]]" : fmt::format("\"{}\"", nearest));
  return -1;
}

std::optional<Error> order_error(const std::vector<Placement>& items, std::size_t index, const char* noun) {
  const auto find = [&](const std::string& name) {
    return std::find_if(items.begin(), items.end(), [&](const Placement& item) { return item.name == name; });
  };
  const Placement& item = items[index];
  if (item.on.empty()) return {};
  const auto below = find(item.on);
  if (below == items.end() || static_cast<std::size_t>(below - items.begin()) < index) return {};
  const auto error = [&](const std::string& found) {
    return Error{fmt::format("`on` must name a {} before this one", noun), found, "", ""};
  };
  if (item.on == item.name) return error(fmt::format("\"{}\", the {} itself", item.on, noun));
  std::string circle = fmt::format("\"{}\" on \"{}\"", item.name, item.on);
  auto next = below;
  for (std::size_t step = 0; step < items.size() && next != items.end() && !next->on.empty(); ++step) {
    circle += fmt::format(" on \"{}\"", next->on);
    if (next->on == item.name) return error("a circle, " + circle);
    next = find(next->on);
  }
  return error(fmt::format("\"{}\", which comes behind it", item.on));
}

Result<Scene> build_scene(const SceneDescription& description) {
  if (const Result<void> sound = check_description(description); !sound) return sound.error();
  SceneBuilder builder(description);
  Scene scene;
  scene.name = description.name;
  scene.description = description.description;
  scene.world.gravity_W = description.gravity_W;
  // Each step builds on those before it.
  for (const auto build : {build_bodies, build_fields, build_settings, build_hand, build_goals})
    if (!builder.errors()) build(builder, scene);
  if (builder.errors()) return builder.errors().error();
  return scene;
}

}  // namespace tactum::inline v0_1
