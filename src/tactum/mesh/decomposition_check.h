#pragma once
/// From convex bodies to pieces, the joining of pieces that are convex together, and the proof that all are
/// the solid.

#include <vector>

#include "tactum/base/result.h"
#include "tactum/geometry/polytope.h"
#include "tactum/mesh/decomposition_solid.h"

namespace tactum::inline v0_1::detail {

/// The hull of a body without reflex edges. An error when it is larger than the body by more than `noise` [m]
/// everywhere on its surface.
Result<Polytope> convex_piece(const std::vector<Vec3>& corners, const Solid& body, double noise);

/// Joins pieces whose union is convex, until there are none: a plane separates the two, and both lie below
/// every other face of either. Returns how many pieces were removed.
int join_convex(std::vector<Polytope>& pieces, double noise);

/// Whether the volumes add up to `volume` within `tolerance` [m^3] and no two pieces overlap by more than
/// `noise` [m].
Result<void> check_pieces(const std::vector<Polytope>& pieces, double volume, double noise, double tolerance);

/// Whether the pieces have a common point that is deeper than `depth` [m] in both.
bool overlap_deeper(const Polytope& a, const Polytope& b, double depth);

/// [m^3]
double volume_of(const Polytope& piece);

}  // namespace tactum::inline v0_1::detail
