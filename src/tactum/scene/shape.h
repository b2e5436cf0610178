#pragma once
/// The shape of a body before it becomes a part: convex pieces made by rule, a mesh from a file or made by
/// rule, or a part that `tactum prepare` made, all in the part's own frame P. The finished part has its
/// origin at the centre of mass, as bodies need it.

#include <memory>
#include <string>
#include <vector>

#include "tactum/base/result.h"
#include "tactum/geometry/part.h"
#include "tactum/geometry/polytope.h"
#include "tactum/mesh/make_part.h"
#include "tactum/mesh/mesh_import.h"
#include "tactum/mesh/part_file.h"
#include "tactum/scene/body_description.h"

namespace tactum::inline v0_1 {

struct Shape {
  std::vector<Polytope> pieces;  ///< made by rule; empty for a mesh
  RoundPiece stands_for;         ///< of a ball or cylinder, whose facets are the only piece; kNone: of none
  std::string file;              ///< where the mesh came from; empty when made by rule
  ImportedMesh mesh;             ///< in metres
  bool given = false;            ///< the mesh's groups are the convex pieces
  PieceSource piece_source = PieceSource::kAuto;  ///< from a mesh that is not given in pieces
  std::shared_ptr<const PartFile> prepared;       ///< instead of a mesh
};

/// The part about its centre of mass; Part::origin is the place of that in P. With `inertial` mass, centre
/// and inertia are those; a prepared part, which stands about its own centre, is then refused.
Result<std::shared_ptr<const Part>> part_of(const Shape& shape, double density_kg_per_m3,
                                            const InertialDescription* inertial = nullptr);

}  // namespace tactum::inline v0_1
