/// tactum import FILE -o SCENE.toml: a URDF or MJCF file as a scene file.

#include <fmt/format.h>

#include <filesystem>

#include "commands.h"
#include "robot_scene.h"
#include "tactum/scene/build_scene.h"
#include "tactum/scene/scene_file.h"

namespace tactum {
namespace {

namespace fs = std::filesystem;

struct ImportCommand {
  std::string file;
  std::string scene;
  std::string tool;
  std::string json;
};

nlohmann::ordered_json notes_json(const ImportedScene& imported, const Scene& scene) {
  nlohmann::ordered_json notes = nlohmann::ordered_json::array();
  for (const ImportNote& note : imported.notes)
    notes.push_back({{"file", note.file}, {"line", note.line}, {"what", note.text}});
  return {{"bodies", scene.world.bodies.size()}, {"notes", notes}, {"chosen", imported.sentences}};
}

void import_file(const ImportCommand& options) {
  check_writable(options.json);
  std::FILE* out = options.json == "-" ? stderr : stdout;
  const std::string folder = fs::absolute(options.scene).parent_path().string();
  const RobotScene robot = read_robot(options.file, {.tool = options.tool, .folder = folder}, out);
  const Result<Scene> scene = build_scene(robot.description);
  if (!scene) fail(scene.error());
  write_text(options.scene, robot.imported.toml);
  std::size_t jointed = 0, fixed = 0;
  for (std::size_t i = 0; i < scene->world.bodies.size(); ++i) {
    const JointKind kind = scene->world.joint_of(static_cast<int>(i)).kind;
    fixed += kind == JointKind::kFixed ? 1 : 0;
    jointed += kind != JointKind::kFixed && kind != JointKind::kFree ? 1 : 0;
  }
  const std::size_t all = scene->world.bodies.size();
  fmt::print(
      out, "{}: {} {}, of which {} on joints, {} free and {} fixed; {} of the file {} not honoured\n",
      options.scene, all, all == 1 ? "body" : "bodies", jointed, all - jointed - fixed, fixed,
      robot.imported.notes.size() == 1 ? "1 thing" : fmt::format("{} things", robot.imported.notes.size()),
      robot.imported.notes.size() == 1 ? "is" : "are");
  if (!options.json.empty()) write_json(options.json, notes_json(robot.imported, *scene));
}

}  // namespace

RobotScene read_robot(const std::string& path, const ImportChoices& choices, std::FILE* out) {
  Result<ImportedScene> imported = import_scene(path, choices);
  if (!imported) fail(imported.error());
  for (const ImportNote& note : imported->notes) fmt::print(stderr, "{}\n", note.sentence());
  for (const std::string& sentence : imported->sentences) fmt::print(out, "{}\n", sentence);
  std::vector<std::string> folders = data_folders();
  if (!choices.folder.empty()) folders.insert(folders.begin(), choices.folder);
  Result<SceneDescription> description =
      parse_description(imported->toml, imported->name, "the scene of " + path, folders);
  if (!description) fail(description.error());
  return {std::move(*imported), std::move(*description)};
}

void add_import(CLI::App& app) {
  auto options = std::make_shared<ImportCommand>();
  CLI::App* command = app.add_subcommand("import", "Make a scene file of a URDF or MJCF file");
  command->add_option("FILE", options->file, "A URDF (.urdf) or MJCF (.xml) file")->required();
  command->add_option("-o,--output", options->scene, "The scene file to write (.toml)")
      ->required()
      ->check([](const std::string& path) {
        return path.ends_with(".toml") ? std::string() : "expected a name that ends in .toml, found " + path;
      });
  command->add_option("--tool", options->tool,
                      "The body that the hand holds; by default the first that is free, else the end of the "
                      "longest chain");
  command->add_option("--json", options->json,
                      "Write what is not honoured, by line, to this file (- for standard output)");
  command->callback([options] { import_file(*options); });
}

}  // namespace tactum
