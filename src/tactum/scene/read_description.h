#pragma once
/// TOML into a description. For src/tactum/scene/*.cpp only: it shows toml++.

#include "tactum/scene/scene_description.h"
#include "tactum/scene/toml_reader.h"

namespace tactum::inline v0_1 {

/// Reads a whole file into `scene`, whose source names it, and stores there the places of its items. Unknown
/// keys, wrong types and numbers out of range go to `errors`.
void read_description(const toml::table& document, SceneDescription& scene, FirstError& errors);

/// Reads a file that has nothing but a table [settings], over those of the scene. Errors call it `file`.
void read_changes(const toml::table& document, const std::string& file, SettingsDescription& settings,
                  FirstError& errors);

}  // namespace tactum::inline v0_1
