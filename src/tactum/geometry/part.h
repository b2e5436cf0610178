#pragma once
/// A part: what a mesh becomes before it can be felt. Convex pieces under a hierarchy of boxes, mass, and for
/// every piece the contact patch it belongs to. All ways to pieces are exact to the input surface:
///
///   given convex pieces       solid polytopes, each a patch of its own
///   a closed convex mesh      one solid polytope
///   any other mesh            a flat polytope per triangle, one-sided: outside is where piece_normal points;
///                             coplanar connected triangles share a patch, so a subdivided wall is one
///                             contact
///
/// The part's frame is the mesh's. Pieces of surfaces have no inside and no penetration depth.

#include <string>
#include <vector>

#include "tactum/base/result.h"
#include "tactum/geometry/bvh.h"
#include "tactum/geometry/mass_properties.h"
#include "tactum/geometry/mesh_import.h"
#include "tactum/geometry/polytope.h"
#include "tactum/geometry/triangle_mesh.h"

namespace tactum {

struct Part {
  std::string name;
  TriangleMesh surface;            ///< welded, without degenerate triangles [m]
  std::vector<Polytope> pieces;    ///< in the part's frame
  std::vector<int> surface_group;  ///< of each piece: its contact patch, 0 .. group_count - 1
  int group_count = 0;
  bool one_sided = false;          ///< the pieces are triangles of the surface
  std::vector<Vec3> piece_normal;  ///< of one-sided pieces: unit, outward [-]; else empty
  Bvh hierarchy;                   ///< over the pieces
  MassProperties mass;
  double radius = 0.0;               ///< largest distance of a vertex from the centre of mass [m]
  double size = 0.0;                 ///< diagonal of the bounding box [m]
  std::vector<std::string> remarks;  ///< what was repaired or approximated, as sentences
};

struct PartOptions {
  std::string name = {};
  double scale = 1.0;                 ///< metres per unit of the input [m]
  double density_kg_per_m3 = 1000.0;  ///< [kg/m^3]
};

/// Solid pieces from clouds of points; each piece is the hull of its cloud.
Result<Part> part_from_clouds(const std::vector<std::vector<Vec3>>& clouds, const PartOptions& options = {});

/// Solid pieces from the groups of a mesh; each must be closed and convex, or the error names the edge.
Result<Part> part_from_convex_groups(const ImportedMesh& mesh, const PartOptions& options = {});

/// One solid piece when the mesh is closed and convex, else a one-sided piece per triangle.
Result<Part> part_from_mesh(const TriangleMesh& mesh, const PartOptions& options = {});

/// The patch of each triangle: connected triangles in one plane, to the tolerances kCoplanarMeshSine and
/// kCoplanarMeshOffset. Patches grow from the largest triangles, whose planes are known best. Numbered from
/// 0.
std::vector<int> coplanar_groups(const TriangleMesh& welded);

}  // namespace tactum
