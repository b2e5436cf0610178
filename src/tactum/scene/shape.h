#pragma once
/// What a body is made of before it becomes a part: convex pieces made by rule, or a mesh from a file, both
/// told in the part's own frame P. The part that comes out has its origin at the centre of mass, as bodies
/// want it.

#include <memory>
#include <string>
#include <vector>

#include "tactum/base/result.h"
#include "tactum/geometry/mesh_import.h"
#include "tactum/geometry/part.h"
#include "tactum/geometry/polytope.h"

namespace tactum {

struct Shape {
  std::vector<Polytope> pieces;  ///< made by rule; empty for a mesh
  std::string file;              ///< where the mesh came from; empty for pieces
  ImportedMesh mesh;             ///< of the file, in metres
  bool given = false;            ///< the mesh's groups are the convex pieces
};

/// In P [m].
Result<Vec3> centre_of_mass(const Shape& shape);

/// The part seen from `origin` [m].
Result<std::shared_ptr<const Part>> part_about(const Vec3& origin, const Shape& shape,
                                               double density_kg_per_m3);

}  // namespace tactum
