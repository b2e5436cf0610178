#include "tactum/scene/scene_files.h"

#include <toml++/toml.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

namespace tactum::inline v0_1 {
namespace {

namespace fs = std::filesystem;

Result<std::string> found_file(const SceneDescription& scene, const std::string& name) {
  const std::vector<std::string> only{""};
  std::error_code ignored;
  for (const std::string& folder : fs::path(name).is_absolute() ? only : scene.source.folders)
    if (const fs::path path = fs::path(folder) / name; fs::is_regular_file(path, ignored))
      return path.string();
  return Error{"cannot find a file of the scene", name, "a file in one of its folders", scene.source.file};
}

/// The buffers that a text of glTF keeps in files of their own.
std::vector<std::string> buffers_of(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  const nlohmann::json document = nlohmann::json::parse(stream, nullptr, false);
  std::vector<std::string> buffers;
  if (!document.is_object() || !document.contains("buffers")) return buffers;
  for (const nlohmann::json& buffer : document["buffers"]) {
    if (!buffer.is_object() || !buffer.contains("uri") || !buffer["uri"].is_string()) continue;
    const auto uri = buffer["uri"].get<std::string>();
    if (!uri.starts_with("data:")) buffers.push_back(uri);
  }
  return buffers;
}

/// The file with the numbers of a field's grid.
std::vector<std::string> data_of(const std::string& header) {
  try {
    const toml::table document = toml::parse_file(header);
    if (const auto data = document["data"].value<std::string>()) return {*data};
  } catch (const toml::parse_error&) {  // whoever reads the field tells what is wrong with it
  }
  return {};
}

}  // namespace

Result<std::vector<SceneFile>> files_of(const SceneDescription& scene) {
  std::vector<std::string> meshes, fields;
  SceneDescription looked_at = scene;
  looked_at.fields.clear();
  const auto note_in = [](std::vector<std::string>& names) {
    return [&names](const std::string& name) {
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
      return name;
    };
  };
  move_files(looked_at, note_in(meshes));
  looked_at.bodies.clear();
  looked_at.fields = scene.fields;
  move_files(looked_at, note_in(fields));
  std::vector<SceneFile> files;
  for (const auto* names : {&meshes, &fields})
    for (const std::string& name : *names) {
      Result<std::string> path = found_file(scene, name);
      if (!path) return path.error();
      SceneFile file{name, *path, {}};
      if (names == &fields)
        file.beside = data_of(*path);
      else if (path->ends_with(".gltf"))
        file.beside = buffers_of(*path);
      files.push_back(std::move(file));
    }
  return files;
}

}  // namespace tactum::inline v0_1
