#pragma once
/// Signed distance, normal and closest features of two convex pieces, tracked from frame to frame and
/// certified.
///
///      walk (voronoi_march.h)  ->  closest points, distance d, normal n of their features
///      check: supports of both pieces along n         separation(n) >= d - 1e-9 size     -> certified
///
/// The points lie on the pieces, so d is an upper bound; the support planes' gap is a rigorous lower bound:
/// where they agree the answer is right, however the walk came to it. Where they do not, in this order: the
/// walk again from the supports just found, with wider Voronoi slack; the normal put back into its features'
/// cones (gaps so small that the points' difference has lost its direction); the walk on the Minkowski
/// difference; distance by support mapping [Gilbert 1988]; every pair of features of
/// small pieces. Each is judged by the same check, and the stop says which it was.
///
/// Overlapping pieces are found by a point of both, and answered by penetration.h.
/// Cost: see docs/algorithms/closest_features.md.

#include "tactum/collision/contact.h"
#include "tactum/geometry/polytope.h"

namespace tactum {

/// `cache` holds the pair's features of the last frame, or is value-initialised; it is brought up to date.
PairDistance closest_features(const Polytope& A, const Polytope& B, const Pose& X_AB,
                              PairCache& cache) noexcept;

}  // namespace tactum
