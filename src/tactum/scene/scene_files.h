#pragma once
/// The files that a scene needs beside its own, by the names its description has for them: so that a scene
/// can be carried to another machine whole.

#include <string>
#include <vector>

#include "tactum/base/result.h"
#include "tactum/scene/scene_description.h"

namespace tactum::inline v0_1 {

struct SceneFile {
  std::string name;  ///< as the description has it
  std::string path;  ///< where it was found
  std::vector<std::string>
      beside;  ///< what it names in turn, relative to its folder: buffers, a field's data
};

/// Each once, in the order of the description. An error where one cannot be found or read.
Result<std::vector<SceneFile>> files_of(const SceneDescription& scene);

/// The description with every name of a file replaced by what `place_of` makes of it.
template <class PlaceOf>
void move_files(SceneDescription& scene, const PlaceOf& place_of) {
  const auto move_part = [&](std::optional<PartDescription>& part) {
    if (auto* mesh = part ? std::get_if<MeshPart>(&*part) : nullptr) mesh->mesh = place_of(mesh->mesh);
  };
  for (BodyDescription& body : scene.bodies) {
    move_part(body.part);
    for (ComponentDescription& component : body.components) move_part(component.part);
  }
  for (FieldDescription& field : scene.fields)
    if (auto* grid = std::get_if<GridDescription>(&field.shape)) grid->file = place_of(grid->file);
}

}  // namespace tactum::inline v0_1
