#pragma once
/// A solid cut into convex pieces along its reflex edges [Bajaj and Dey 1992]: exact to the surface given.
///
///      _____                 _____         Coplanar triangles are one face, so only true edges are left.
///     |     |               |     |        While a body has a reflex edge, it is cut by the plane through
///     |     |____    -->    |- - -|____    one that frees the most reflex edges and crosses the fewest.
///     |          |          |          |   Bodies that come apart go on alone; what has no reflex edge is
///     |__________|          |__________|   convex. At last, pieces that are convex together are joined.
///
/// It differs from the source: cuts go through the whole body rather than the one cross-section that holds
/// the edge, and pieces that were cut in vain are joined again; the plane is chosen by count, where the
/// source takes any. Robust by counting: see decomposition_cut.h. The result is proved, not trusted: the
/// volumes of the pieces add up to the volume of the solid, and no two pieces overlap.
///
/// For parts of few pieces, where tracked pairs are fastest; a part of many is better felt by its surface.
/// See docs/algorithms/decomposition.md.

#include <vector>

#include "tactum/base/result.h"
#include "tactum/geometry/polytope.h"
#include "tactum/geometry/triangle_mesh.h"

namespace tactum::inline v0_1 {

/// Up to so many pieces the solid is better than the surface, measured by the cost of near pairs.
inline constexpr int kFewSolidPieces = 32;

struct SolidPieces {
  std::vector<Polytope> pieces;
  int reflex_edges = 0;  ///< of the solid given
  int cuts = 0;
  int joined = 0;  ///< pieces that became part of a neighbour
};

/// The pieces of a welded mesh with normals outward. An error says, with a place, that the mesh is open or
/// not manifold or crosses itself, or that it would take more than `most_pieces` pieces. Cost: milliseconds
/// for tens of pieces.
Result<SolidPieces> solid_pieces(const TriangleMesh& mesh, int most_pieces);

}  // namespace tactum::inline v0_1
