#pragma once
/// Whether a description made in code says what a file could say: ranges, finite numbers, one thing said
/// once. What needs parts and bodies, such as names, is checked when the scene is built.

#include "tactum/base/result.h"
#include "tactum/scene/scene_description.h"

namespace tactum::inline v0_1 {

/// The first item that is wrong. Cost: linear in the number of items.
Result<void> check_description(const SceneDescription& scene);

}  // namespace tactum::inline v0_1
