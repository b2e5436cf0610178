#include "tactum/import/import_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "tactum/import/mjcf_reader.h"
#include "tactum/import/model_mass.h"
#include "tactum/import/urdf_reader.h"

namespace tactum::inline v0_1 {
namespace {

namespace fs = std::filesystem;

Result<ImportedScene> import_tree(XmlElement& root, const std::string& file, const ImportChoices& choices) {
  const bool urdf = root.name == "robot";
  if (!urdf && root.name != "mujoco")
    return Error{"neither URDF nor MJCF", fmt::format("<{}>", root.name), "<robot> or <mujoco>",
                 place_of(root)};
  ImportLog log;
  const std::string folder = fs::path(file).parent_path().string();
  ImportModel model = urdf ? read_urdf(root, folder, log) : read_mjcf(root, folder, log);
  ModelMeshes meshes;
  if (!log.errors()) complete_masses(model, meshes, log);
  WrittenScene written;
  if (!log.errors()) written = write_scene(model, choices, meshes, log);
  if (log.errors()) return log.errors().error();
  log.note_unread(root);
  return ImportedScene{.name = fs::path(file).stem().string(),
                       .toml = std::move(written.toml),
                       .notes = log.notes(),
                       .sentences = std::move(written.sentences)};
}

}  // namespace

bool is_robot_name(const std::string& name) {
  std::string ending = fs::path(name).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
  return ending == ".urdf" || ending == ".xml" || ending == ".mjcf";
}

Result<ImportedScene> import_scene(const std::string& path, const ImportChoices& choices) {
  Result<XmlElement> root = read_xml_file(path);
  return root ? import_tree(*root, path, choices) : root.error();
}

Result<ImportedScene> import_scene_text(std::string_view text, const std::string& file,
                                        const ImportChoices& choices) {
  Result<XmlElement> root = parse_xml(text, file);
  return root ? import_tree(*root, file, choices) : root.error();
}

}  // namespace tactum::inline v0_1
