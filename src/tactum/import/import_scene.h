#pragma once
/// Robots and scenes of other programs as scenes: URDF and MJCF. docs/import.md lists what is honoured.
///
///   Result<ImportedScene> imported = import_scene("robot.urdf");
///   for (const ImportNote& note : imported->notes) print(note.sentence());
///   Result<SceneDescription> scene = parse_description(imported->toml, imported->name, "robot.urdf", {});
///
/// Shapes stay what they are: no mesh is made convex, and none is simplified. What a scene cannot say is a
/// note with its line; what would change the mechanics in silence is an error with its line.

#include <string>
#include <string_view>
#include <vector>

#include "tactum/base/result.h"
#include "tactum/import/import_log.h"
#include "tactum/import/scene_writer.h"

namespace tactum::inline v0_1 {

struct ImportedScene {
  std::string name = {};                    ///< the stem of the file's name
  std::string toml = {};                    ///< the scene file
  std::vector<ImportNote> notes = {};       ///< what of the file is not honoured, by line
  std::vector<std::string> sentences = {};  ///< what was chosen
};

/// Whether the name ends in .urdf, .xml or .mjcf.
bool is_robot_name(const std::string& name);

/// The scene of a URDF or MJCF file, which its root element tells apart. Meshes are loaded, each once, for
/// masses that follow from them.
Result<ImportedScene> import_scene(const std::string& path, const ImportChoices& choices = {});

/// The same from a text. Errors and notes call it `file`, and what it names is seen from that file's folder.
Result<ImportedScene> import_scene_text(std::string_view text, const std::string& file,
                                        const ImportChoices& choices = {});

}  // namespace tactum::inline v0_1
