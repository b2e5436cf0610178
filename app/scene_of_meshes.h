#pragma once
/// A scene of meshes as people have them: one above a plate, or one above another, with the unit guessed.

#include <string>
#include <vector>

#include "tactum/scene/scene_description.h"

namespace tactum {

/// Whether the name is that of a mesh file, or of a part that `tactum prepare` wrote.
bool is_mesh_name(const std::string& name);

struct MeshScene {
  std::string toml;                    ///< the scene as a file
  std::vector<std::string> sentences;  ///< the unit of each mesh, and why
};

/// The scene in which the last mesh is held above a fixed plate of its size, or above the first of two. A
/// scene that is saved in `folder` names its meshes from there, so that both can be moved together; without a
/// folder by their whole paths. Ends the command when a mesh cannot be read.
MeshScene scene_of_meshes(const std::vector<std::string>& meshes, const std::string& folder);

}  // namespace tactum
