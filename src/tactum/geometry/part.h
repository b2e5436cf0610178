#pragma once
/// A part: what a mesh becomes before it can be felt. Convex pieces under a hierarchy of boxes, mass, and for
/// every piece the contact patch it belongs to. All ways to pieces are exact to the input surface:
///
///   given convex pieces       solid polytopes, each a patch of its own
///   a closed convex mesh      one solid polytope
///   a closed mesh of few      solid polytopes, cut apart at the reflex edges (decomposition.h)
///   reflex edges
///   any other mesh            no pieces: the surface itself, felt from outside (surface_tree.h)
///
/// Every part has the tree of its surface, so that solids can meet surfaces. The part's frame has the axes of
/// the input, and its origin too, unless the part is made about its centre of mass, as bodies need it.

#include <string>
#include <vector>

#include "tactum/base/result.h"
#include "tactum/geometry/bvh.h"
#include "tactum/geometry/mass_properties.h"
#include "tactum/geometry/mesh_import.h"
#include "tactum/geometry/polytope.h"
#include "tactum/geometry/surface_tree.h"
#include "tactum/geometry/triangle_mesh.h"
#include "tactum/geometry/true_surface.h"

namespace tactum {

/// Where the pieces of a mesh come from.
enum class PieceSource {
  kAuto,     ///< solid when that takes few pieces, else the surface
  kGiven,    ///< the groups of the mesh
  kSolid,    ///< the solid, cut apart at its reflex edges
  kSurface,  ///< the triangles
};

struct Part {
  std::string name;
  std::string way;  ///< how the pieces were made, and why so: "solid: 13 convex pieces from 8 reflex edges"
  TriangleMesh surface;            ///< welded, without degenerate triangles [m]
  std::vector<Polytope> pieces;    ///< in the part's frame
  std::vector<int> surface_group;  ///< of each piece: its contact patch, 0 .. group_count - 1
  int group_count = 0;
  Bvh hierarchy;             ///< over the pieces
  TrueSurface true_surface;  ///< what of solid pieces can be touched; alone() for surfaces
  SurfaceTree tree;          ///< over the surface
  MassProperties mass;
  Vec3 origin = Vec3::Zero();        ///< the part's origin, in the frame of the input [m]
  double radius = 0.0;               ///< largest distance of a vertex from the centre of mass [m]
  double size = 0.0;                 ///< diagonal of the bounding box [m]
  std::vector<std::string> remarks;  ///< what was repaired or approximated, as sentences

  /// Whether it is felt by its surface, not by convex pieces.
  bool is_surface() const noexcept { return pieces.empty(); }
};

struct PartOptions {
  std::string name = {};
  double scale = 1.0;                 ///< metres per unit of the input [m]
  double density_kg_per_m3 = 1000.0;  ///< [kg/m^3]
  PieceSource pieces = PieceSource::kAuto;
  bool about_center_of_mass = false;  ///< the part's origin is its centre of mass (Part::origin says where)
  int most_solid_pieces = 0;  ///< 0: 32 where the way is chosen by itself, 512 where solid is asked for
};

/// Solid pieces from clouds of points; each piece is the hull of its cloud.
Result<Part> part_from_clouds(const std::vector<std::vector<Vec3>>& clouds, const PartOptions& options = {});

/// Solid pieces from the groups of a mesh; each must be closed and convex, or the error names the edge.
Result<Part> part_from_convex_groups(const ImportedMesh& mesh, const PartOptions& options = {});

/// By `options.pieces`. An error when a solid is asked for and the mesh is none, or would take too many
/// pieces. Given pieces are groups, which a bare mesh has not: see part_from_convex_groups.
Result<Part> part_from_mesh(const TriangleMesh& mesh, const PartOptions& options = {});

/// Finds what of the pieces can be touched, from the pieces and their hierarchy.
void find_true_surface(Part& part);

/// The patch of each triangle: connected triangles in one plane, to the tolerances kCoplanarMeshSine and
/// kCoplanarMeshOffset. Patches grow from the largest triangles, whose planes are known best. Numbered from
/// 0.
std::vector<int> coplanar_groups(const TriangleMesh& welded);

}  // namespace tactum
