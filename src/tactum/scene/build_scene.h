#pragma once
/// From a description to the scene that sessions and simulations run.

#include "tactum/base/result.h"
#include "tactum/scene/scene.h"
#include "tactum/scene/scene_description.h"

namespace tactum::inline v0_1 {

/// Makes parts, bodies, fields, settings, the hand's motion and goals. An error names the item: by line and
/// column when the description comes from a file, else by its path, "body[2].joint.axis". Equal descriptions
/// give scenes with the same bits. Slow: it reads meshes and cuts parts; allocates.
Result<Scene> build_scene(const SceneDescription& description);

}  // namespace tactum::inline v0_1
