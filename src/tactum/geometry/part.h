#pragma once
/// A part: convex pieces under a hierarchy of boxes, or a surface alone; mass; and for every piece the
/// contact patch it belongs to. mesh/make_part.h makes parts.
///
/// Every part has the tree of its surface, so that solids can meet surfaces. The part's frame has the axes of
/// the input, and its origin too, unless the part is made about its centre of mass, as bodies need it.

#include <string>
#include <vector>

#include "tactum/geometry/bvh.h"
#include "tactum/geometry/mass_properties.h"
#include "tactum/geometry/polytope.h"
#include "tactum/geometry/round_piece.h"
#include "tactum/geometry/surface_tree.h"
#include "tactum/geometry/triangle_mesh.h"
#include "tactum/geometry/true_surface.h"

namespace tactum::inline v0_1 {

/// How a part was made, in words for a person.
struct PartNotes {
  /// How the pieces were made, and the reason: "solid: 13 convex pieces from 8 reflex edges".
  std::string pieces;
  std::vector<std::string> remarks;  ///< repairs and approximations, as sentences
};

/// The groups of a part's surface: contact patches that lie on the same two groups have one stiffness
/// together. Each piece is a group; of a part that is felt by its surface these are the coplanar groups of
/// the triangles; the tree of the surface knows which triangle belongs to which.
struct SurfaceGroups {
  /// Of each piece: the sphere or cylinder that it was made to stand for. Empty: the facets are what was
  /// meant.
  std::vector<RoundPiece> rounds;
  std::vector<int> of_piece;  ///< of each piece: its group, 0 .. count - 1
  int count = 0;
};

struct Part {
  std::string name;
  PartNotes notes;
  TriangleMesh surface;          ///< welded, without degenerate triangles [m]
  std::vector<Polytope> pieces;  ///< in the part's frame
  SurfaceGroups groups;
  Bvh hierarchy;             ///< over the pieces
  TrueSurface true_surface;  ///< exposed features of solid pieces; single_piece() for surfaces
  SurfaceTree tree;          ///< over the surface
  MassProperties mass;
  Vec3 origin = Vec3::Zero();  ///< the part's origin, in the frame of the input [m]
  double radius = 0.0;         ///< largest distance of a vertex from the centre of mass [m]
  double size = 0.0;           ///< diagonal of the bounding box [m]

  /// Whether it is felt by its surface, not by convex pieces.
  bool is_surface() const noexcept { return pieces.empty(); }
};

/// Finds the exposed features of the pieces, from the pieces and their hierarchy.
void find_true_surface(Part& part);

}  // namespace tactum::inline v0_1
