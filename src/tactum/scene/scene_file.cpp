#include "tactum/scene/scene_file.h"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "tactum/scene/scene_sections.h"

namespace tactum {
namespace {

constexpr int kSchema = 1;
constexpr std::uintmax_t kMaxBytes = 1 << 20;  // of a scene file; parts are in files of their own

void read_root(const TomlReader& root, const SearchFolders& folders, Scene& scene) {
  root.integer("schema", {}, kSchema, kSchema);
  if (root.errors()) return;
  scene.description = root.text("description", "");
  scene.world.gravity_W = root.vector3("gravity_m_per_s2", Vec3::Zero());
  // Each section builds on those before it.
  read_bodies(root, folders, scene);
  if (!root.errors()) read_fields(root, folders, scene);
  if (!root.errors()) read_settings(root, scene);
  if (!root.errors()) read_hand(root, scene);
  if (!root.errors()) read_goals(root, scene);
}

}  // namespace

Result<Scene> parse_scene(std::string_view text, const std::string& name, const std::string& file,
                          const std::vector<std::string>& mesh_folders) {
  toml::table document;
  try {
    document = toml::parse(text, file);
  } catch (const toml::parse_error& error) {
    return Error{"not TOML", std::string(error.description()), "", place(file, error.source().begin)};
  }
  Scene scene;
  scene.name = name;
  FirstError errors;
  const TomlReader root(
      document, file, "",
      {"schema",    "description", "gravity_m_per_s2", "dt_s",     "device",      "workspace", "coupling",
       "response",  "penalty",     "constraint",       "friction", "restitution", "impacts",   "shading",
       "smoothing", "safety",      "budget",           "body",     "tool",        "hand",      "goal",
       "field"},
      errors);
  read_root(root, mesh_folders, scene);
  if (errors) return errors.error();
  return scene;
}

Result<Scene> read_scene_file(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code failure;
  if (!fs::is_regular_file(path, failure))
    return Error{"cannot read the scene", "no such file", "a scene file (.toml)", path};
  const std::uintmax_t size = fs::file_size(path, failure);
  if (failure || size > kMaxBytes)
    return Error{"cannot read the scene", failure ? failure.message() : "more than a megabyte",
                 "a scene file (.toml)", path};
  std::string text(size, '\0');
  std::ifstream stream(path, std::ios::binary);
  if (!stream.read(text.data(), static_cast<std::streamsize>(size)))
    return Error{"cannot read the scene", "a read error", "a readable file", path};
  std::vector<std::string> folders = data_folders();
  folders.insert(folders.begin(), fs::path(path).parent_path().string());
  return parse_scene(text, fs::path(path).stem().string(), path, folders);
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

}  // namespace tactum
