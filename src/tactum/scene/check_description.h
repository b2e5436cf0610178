#pragma once
/// Checks that a description made in code could come from a file: ranges, finite numbers, no item given
/// twice. Checks that need parts and bodies, such as those of names, are made when the scene is built.

#include "tactum/base/result.h"
#include "tactum/scene/scene_description.h"

namespace tactum::inline v0_1 {

/// The first item that is wrong. Cost: linear in the number of items.
Result<void> check_description(const SceneDescription& scene);

}  // namespace tactum::inline v0_1
