#include "tactum/scene/builtin_scenes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>

#include "tactum/scene/build_scene.h"
#include "tactum/scene/scene_file.h"
#include "tactum/scene/toml_reader.h"

namespace tactum::inline v0_1 {

std::vector<SceneEntry> list_scenes() {
  std::vector<SceneEntry> entries;
  for (const BuiltinScene& scene : builtin_scenes()) {
    const toml::table document = toml::parse(scene.text);  // shipped scenes are tested to parse
    entries.push_back({std::string(scene.name), document["description"].value_or(std::string())});
  }
  return entries;
}

Result<SceneDescription> describe_scene(const std::string& name_or_path) {
  if (name_or_path.ends_with(".toml") || name_or_path.find('/') != std::string::npos)
    return read_description_file(name_or_path);
  std::vector<std::string> names;
  for (const BuiltinScene& scene : builtin_scenes()) {
    if (scene.name == name_or_path)
      return parse_description(scene.text, name_or_path, fmt::format("scenes/{}.toml", name_or_path),
                               data_folders());
    names.emplace_back(scene.name);
  }
  const std::string nearest = nearest_word(name_or_path, names);
  return Error{"no scene of this name", fmt::format("\"{}\"", name_or_path),
               nearest.empty() ? fmt::format("one of {}, or a path to a .toml file", fmt::join(names, ", "))
                               : fmt::format("\"{}\", or a path to a .toml file", nearest),
               ""};
}

std::vector<std::string> missing_files(const SceneDescription& scene) {
  namespace fs = std::filesystem;
  std::vector<std::string> missing;
  const auto look = [&](const std::string& file) {
    std::error_code ignored;
    bool there = fs::path(file).is_absolute() && fs::is_regular_file(file, ignored);
    for (const std::string& folder : scene.source.folders)
      there = there || fs::is_regular_file(fs::path(folder) / file, ignored);
    if (!there) missing.push_back(file);
  };
  const auto look_at_part = [&](const std::optional<PartDescription>& part) {
    if (part && std::holds_alternative<MeshPart>(*part)) look(std::get<MeshPart>(*part).mesh);
  };
  for (const BodyDescription& body : scene.bodies) {
    look_at_part(body.part);
    for (const ComponentDescription& component : body.components) look_at_part(component.part);
  }
  for (const FieldDescription& field : scene.fields)
    if (const auto* grid = std::get_if<GridDescription>(&field.shape)) look(grid->file);
  return missing;
}

Result<Scene> open_scene(const std::string& name_or_path) {
  const Result<SceneDescription> scene = describe_scene(name_or_path);
  return scene ? build_scene(*scene) : scene.error();
}

}  // namespace tactum::inline v0_1
