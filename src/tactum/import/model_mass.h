#pragma once
/// Mass and inertia of links: as they are stated, or from their shapes.

#include <map>
#include <string>
#include <utility>

#include "tactum/geometry/mass_properties.h"
#include "tactum/import/import_log.h"
#include "tactum/import/import_model.h"

namespace tactum::inline v0_1 {

/// What the import knows of a mesh, in the frame of its file, scaled.
struct ModelMesh {
  MassProperties mass = {};  ///< of density 1
  Aabb box = {};             ///< [m]
};

/// The meshes of a model, each loaded once for each scale.
class ModelMeshes {
 public:
  /// Null, and an error at the shape, when the file cannot be read.
  const ModelMesh* find(const ModelShape& shape, ImportLog& log);

 private:
  std::map<std::pair<std::string, std::array<double, 3>>, ModelMesh> meshes_;
};

/// The sum of two inertias of one frame.
ModelInertial together(const ModelInertial& a, const ModelInertial& b);

/// The same inertia in another frame, in which the old one stands at X.
ModelInertial placed(const Pose& X, const ModelInertial& inertial);

/// The inertia of one shape in the link's frame; of balls, cylinders and capsules that of the true solids.
ModelInertial inertial_of(const ModelShape& shape, ModelMeshes& meshes, ImportLog& log);

/// Gives links their inertia by the rules of the model; a link without shapes and without a stated one gets
/// none.
void complete_masses(ImportModel& model, ModelMeshes& meshes, ImportLog& log);

}  // namespace tactum::inline v0_1
