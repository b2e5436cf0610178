#pragma once
/// Whether what is made to fit does: pegs in holes, keys in sockets, nuts on bolts, by their described sizes.
/// For src/tactum/scene/*.cpp only.

#include <string>
#include <vector>

#include "tactum/scene/scene_description.h"

namespace tactum::inline v0_1 {

/// A sentence for each part that fits none of the parts it could belong to.
std::vector<std::string> fit_remarks(const SceneDescription& scene);

/// "0.5 mm", "1.2 m", "30 um".
std::string length_text(double length_m);

}  // namespace tactum::inline v0_1
