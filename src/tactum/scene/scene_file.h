#pragma once
/// Scene files: strict TOML, `schema = 1`. Every key has its unit in its name; an unknown key, a wrong type,
/// a number out of range or a name that leads nowhere is an error "FILE:LINE:COLUMN: what: found ...,
/// expected ...".
///
/// Poses in a file speak of a part's own frame (that of its mesh file, or as generated_parts.h and gear.h
/// draw it); the World that comes out speaks of centres of mass. docs/scene-format.md lists the keys.

#include <string>
#include <string_view>
#include <vector>

#include "tactum/base/result.h"
#include "tactum/scene/scene.h"

namespace tactum {

/// The scene of a file. Meshes are looked for beside the file, then in data_folders().
Result<Scene> read_scene_file(const std::string& path);

/// The same from text. `file` is how errors call it; `mesh_folders` are searched in order.
Result<Scene> parse_scene(std::string_view text, const std::string& name, const std::string& file,
                          const std::vector<std::string>& mesh_folders);

/// The folders named by the environment's TACTUM_DATA, colons between.
std::vector<std::string> data_folders();

}  // namespace tactum
