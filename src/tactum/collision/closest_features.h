#pragma once
/// Signed distance, normal and closest features of two convex pieces, tracked from frame to frame and
/// certified.
///
///      walk (vclip.h)    ->  closest points, distance d, normal n of their features, and a lower
///                                    bound d - error_bound from the walk's own last tests
///      error_bound <= 1e-9 size  ->  certified
///
/// The points lie on the pieces, so d is an upper bound: where both bounds agree the answer is right, however
/// the walk came to it. Where they do not, true supports along n give the lower bound, and the points are
/// searched in this order: the normal put back into its features' cones (for gaps so small that the points'
/// difference has lost its direction); the walk again from the supports just found, with a wider crossing
/// tolerance; the walk on the Minkowski difference; distance by support mapping [Gilbert 1988]; brute force
/// for small pieces. The stop states which method answered, and `error_bound` the error that is left.
///
/// Overlapping pieces are recognised by a proof that they share a point (overlap.h, support_distance.h), and
/// answered by penetration.h.
/// Cost: see docs/algorithms/closest_features.md.

#include "tactum/collision/contact.h"
#include "tactum/geometry/polytope.h"

namespace tactum::inline v0_1 {

/// `cache` holds the pair's features of the last frame, or is value-initialised; it is updated.
PairDistance closest_features(const Polytope& A, const Polytope& B, const Pose& X_AB,
                              PairCache& cache) noexcept;

}  // namespace tactum::inline v0_1
