#pragma once
/// Whether solid pieces of one part overlap, by separating axes: exhaustive, slow, and independent of the
/// contact core and of whatever cut the pieces.
///
/// Two convex solids are apart exactly when an axis separates them that is a face normal of either or square
/// to an edge of each; the edges' axes count only where their arcs cross on the Gauss map [Gregorius 2013].
/// The largest gap over all axes is the signed distance when negative, and a bound on it when positive. Cost
/// of a pair: edges times edges, a few nanoseconds each, only when no face separates the pieces.

#include <array>
#include <vector>

#include "tactum/geometry/part.h"
#include "tactum/geometry/polytope.h"

namespace tactum::inline v0_1 {

/// Largest gap over all axes [m]; negative: they overlap this deep. Stops at the first gap above `enough`.
double separation(const Polytope& a, const Polytope& b, double enough) noexcept;

struct PieceOverlaps {
  int pairs = 0;                        ///< that overlap deeper than given
  double deepest = 0.0;                 ///< [m]
  std::array<int, 2> worst = {-1, -1};  ///< the pieces that overlap deepest
};

/// Over all pairs of solid pieces of a part whose boxes meet. Flat pieces have no inside and are left out.
PieceOverlaps overlapping_pieces(const Part& part, double deeper_than);

}  // namespace tactum::inline v0_1
