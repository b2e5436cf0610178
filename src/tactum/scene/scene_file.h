#pragma once
/// Scene files: strict TOML, `schema = 1`. Every key has its unit in its name; an unknown key, a wrong type,
/// a number out of range or a name of nothing that exists is an error "FILE:LINE:COLUMN: what: found ...,
/// expected ...".
///
/// A file becomes a description (scene_description.h), and that a scene.
///
/// Poses in a file are those of a part's own frame (that of its mesh file, or as drawn in generated_parts.h
/// and gear.h); those of the World are of centres of mass. docs/scene-format.md lists the keys.

#include <string>
#include <string_view>
#include <vector>

#include "tactum/base/result.h"
#include "tactum/scene/scene.h"
#include "tactum/scene/scene_description.h"

namespace tactum::inline v0_1 {

/// The description in a file. Meshes are searched beside the file, then in data_folders().
Result<SceneDescription> read_description_file(const std::string& path);

/// The same from text. Errors call it `file`; `folders` are searched for meshes in this order.
Result<SceneDescription> parse_description(std::string_view text, const std::string& name,
                                           const std::string& file, const std::vector<std::string>& folders);

/// Puts the settings of a file that has nothing but a table [settings], such as the page saves, over those
/// of a scene.
Result<void> change_settings(const std::string& path, SceneDescription& scene);

/// The same from text. Errors call it `file`.
Result<void> parse_changes(std::string_view text, const std::string& file, SceneDescription& scene);

/// The scene of a file: its description, built (build_scene.h).
Result<Scene> read_scene_file(const std::string& path);

/// The same from text, as in parse_description.
Result<Scene> parse_scene(std::string_view text, const std::string& name, const std::string& file,
                          const std::vector<std::string>& folders);

/// The folders named by the environment's TACTUM_DATA, colons between.
std::vector<std::string> data_folders();

}  // namespace tactum::inline v0_1
