#pragma once
/// URDF and MJCF files on the command line.

#include <cstdio>
#include <string>

#include "tactum/import/import_scene.h"
#include "tactum/scene/scene_description.h"

namespace tactum {

/// A robot file as a scene: what was imported, and its description.
struct RobotScene {
  ImportedScene imported;
  SceneDescription description;
};

/// Imports the file and prints its notes to stderr and what was chosen to `out`. Ends the command where it
/// cannot.
RobotScene read_robot(const std::string& path, const ImportChoices& choices, std::FILE* out);

}  // namespace tactum
