#include "tactum/scene/scene_file.h"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "tactum/scene/build_scene.h"
#include "tactum/scene/read_description.h"
#include "tactum/scene/toml_slips.h"

namespace tactum::inline v0_1 {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxBytes = 1 << 20;  // of a scene file; parts are in files of their own

Result<toml::table> parse_document(std::string_view text, const std::string& file) {
  try {
    return toml::table(toml::parse(text, file));
  } catch (const toml::parse_error& error) {
    return toml_error(text, file, error);
  }
}

/// The text of a TOML file. Errors call what it holds `noun`: "scene".
Result<std::string> text_of(const char* noun, const std::string& path) {
  const auto error = [&](std::string found, const char* expected) {
    return Error{fmt::format("cannot read the {}", noun), std::move(found), expected, path};
  };
  const std::string usual = fmt::format("a {} file (.toml)", noun);
  std::error_code failure;
  if (!fs::is_regular_file(path, failure))
    return error(fs::is_directory(path, failure) ? "a folder" : "no such file", usual.c_str());
  const std::uintmax_t size = fs::file_size(path, failure);
  if (failure || size > kMaxBytes)
    return error(failure ? failure.message() : "more than a megabyte", usual.c_str());
  std::string text(size, '\0');
  std::ifstream stream(path, std::ios::binary);
  if (!stream.read(text.data(), static_cast<std::streamsize>(size)))
    return error("a read error", "a readable file");
  return text;
}

}  // namespace

Result<SceneDescription> parse_description(std::string_view text, const std::string& name,
                                           const std::string& file, const std::vector<std::string>& folders) {
  const Result<toml::table> document = parse_document(text, file);
  if (!document) return document.error();
  SceneDescription scene;
  scene.name = name;
  scene.source.file = file;
  scene.source.folders = folders;
  scene.source.text = text;
  FirstError errors;
  read_description(*document, scene, errors);
  if (errors) return errors.error();
  return scene;
}

Result<SceneDescription> read_description_file(const std::string& path) {
  const Result<std::string> text = text_of("scene", path);
  if (!text) return text.error();
  std::vector<std::string> folders = data_folders();
  folders.insert(folders.begin(), fs::path(path).parent_path().string());
  return parse_description(*text, fs::path(path).stem().string(), path, folders);
}

Result<void> change_settings(const std::string& path, SceneDescription& scene) {
  const Result<std::string> text = text_of("settings", path);
  return text ? parse_changes(*text, path, scene) : text.error();
}

Result<void> parse_changes(std::string_view text, const std::string& file, SceneDescription& scene) {
  const Result<toml::table> document = parse_document(text, file);
  if (!document) return document.error();
  FirstError errors;
  read_changes(*document, file, scene.settings, errors);
  if (errors) return errors.error();
  scene.source.changes = text;
  return {};
}

Result<Scene> parse_scene(std::string_view text, const std::string& name, const std::string& file,
                          const std::vector<std::string>& folders) {
  const Result<SceneDescription> scene = parse_description(text, name, file, folders);
  return scene ? build_scene(*scene) : scene.error();
}

Result<Scene> read_scene_file(const std::string& path) {
  const Result<SceneDescription> scene = read_description_file(path);
  return scene ? build_scene(*scene) : scene.error();
}

std::vector<std::string> data_folders() {
  std::vector<std::string> folders;
  const char* named = std::getenv("TACTUM_DATA");
  std::string_view rest = named ? named : "";
  while (!rest.empty()) {
    const std::size_t colon = rest.find(':');
    if (colon != 0) folders.emplace_back(rest.substr(0, colon));
    rest = colon == std::string_view::npos ? std::string_view() : rest.substr(colon + 1);
  }
  return folders;
}

}  // namespace tactum::inline v0_1
