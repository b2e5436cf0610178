#pragma once
/// What a person should know of a scene before feeling it: how large it is, how far the grasped part is from
/// the rest, and what is probably a mistake, such as sizes in millimetres or bodies that start inside each
/// other. Nothing here changes the scene.

#include <string>
#include <vector>

#include "tactum/scene/scene.h"
#include "tactum/scene/scene_description.h"

namespace tactum::inline v0_1 {

struct SceneRemark {
  bool warning = false;  ///< probably a mistake; else a fact
  std::string text;      ///< a sentence without a full stop
};

/// The remarks on a scene that was built from this description: facts first, then warnings. Exact distances
/// and depths where the bodies start, found by a broad phase and branch and bound: milliseconds, some tens of
/// them for large meshes. Not for the frame.
std::vector<SceneRemark> remarks_on(const SceneDescription& description, const Scene& scene);

}  // namespace tactum::inline v0_1
