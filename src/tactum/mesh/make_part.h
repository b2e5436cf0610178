#pragma once
/// From a mesh, or from convex pieces, to a part. All methods give pieces exact to the input surface:
///
///   given convex pieces       solid polytopes, each a patch of its own
///   a closed convex mesh      one solid polytope
///   a closed mesh of few      solid polytopes, cut apart at the reflex edges (decomposition.h)
///   reflex edges
///   any other mesh            no pieces: the surface itself, felt from outside (surface_tree.h)

#include <optional>
#include <string>
#include <vector>

#include "tactum/base/result.h"
#include "tactum/geometry/mesh_report.h"
#include "tactum/geometry/part.h"
#include "tactum/mesh/imported_mesh.h"
#include "tactum/repair/mesh_repair.h"

namespace tactum::inline v0_1 {

/// Where the pieces of a mesh come from.
enum class PieceSource {
  kAuto,     ///< solid when that takes few pieces, else the surface
  kGiven,    ///< the groups of the mesh
  kSolid,    ///< the solid, cut apart at its reflex edges
  kSurface,  ///< the triangles
};

struct PartOptions {
  std::string name = {};
  double scale = 1.0;                 ///< metres per unit of the input [m]
  double density_kg_per_m3 = 1000.0;  ///< [kg/m^3]
  PieceSource pieces = PieceSource::kAuto;
  bool about_center_of_mass = false;  ///< the part's origin is its centre of mass (Part::origin)
  std::optional<Vec3> origin = {};    ///< ... or this point of the scaled input [m]
  int threads = 1;                    ///< the part does not depend on it
  int most_solid_pieces = 0;  ///< 0: 32 where the method is chosen by itself, 512 where solid is wanted
};

/// Solid pieces from clouds of points; each piece is the hull of its cloud.
Result<Part> part_from_clouds(const std::vector<std::vector<Vec3>>& clouds, const PartOptions& options = {});

/// Solid pieces from the groups of a mesh; each must be closed and convex, or the error names the edge.
Result<Part> part_from_convex_groups(const ImportedMesh& mesh, const PartOptions& options = {});

/// The centre of mass of that part [m]; the pieces are made for it, and nothing else of the part.
Result<Vec3> center_of_convex_groups(const ImportedMesh& mesh, const PartOptions& options = {});

/// By `options.pieces`. An error when a solid is wanted and the mesh is none, or would take too many pieces.
/// Given pieces are groups, which a bare mesh has not: see part_from_convex_groups.
Result<Part> part_from_mesh(const TriangleMesh& mesh, const PartOptions& options = {});

/// The same from a mesh that was repaired before, which needs no second repair. `report` is of that mesh.
/// The notes of the repair are the caller's.
Result<Part> part_from_repaired(RepairedMesh repaired, const MeshReport& report,
                                const PartOptions& options = {});

}  // namespace tactum::inline v0_1
