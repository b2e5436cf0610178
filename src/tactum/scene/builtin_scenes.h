#pragma once
/// The scenes that come with the program: scenes/*.toml, kept inside the binary at build time, in the order
/// of the registry in CMakeLists.txt (tactum_embed_scenes).

#include <string>
#include <string_view>
#include <vector>

#include "tactum/base/result.h"
#include "tactum/scene/scene.h"
#include "tactum/scene/scene_description.h"

namespace tactum::inline v0_1 {

struct BuiltinScene {
  std::string_view name;  ///< "gears"
  std::string_view text;  ///< of its file
};

/// The registry (made at build time).
const std::vector<BuiltinScene>& builtin_scenes();

struct SceneEntry {
  std::string name;
  std::string description;  ///< one line
};

/// Name and description of every built-in scene, in order.
std::vector<SceneEntry> list_scenes();

/// The description of a built-in scene by name, or of a scene file by path. A text that ends in .toml or has
/// a slash is a path. A program may change it before it builds the scene.
Result<SceneDescription> describe_scene(const std::string& name_or_path);

/// The files that a description names and that are in none of its folders: meshes and fields. The scenes that
/// come with the program name some that do not (docs/real-parts.md).
std::vector<std::string> missing_files(const SceneDescription& scene);

/// The scene of that description, built.
Result<Scene> open_scene(const std::string& name_or_path);

}  // namespace tactum::inline v0_1
