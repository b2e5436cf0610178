#pragma once
/// Distance by support mapping alone [Gilbert 1988]: a simplex of the Minkowski difference is moved toward
/// the origin. No features are needed and it cannot cycle; but where the pieces nearly touch, or nearly
/// parallel faces meet, its last digits are lost: the caller's certificate judges it. A fallback. The nearest
/// point of the simplex is taken over all its corners, edges and faces: slower than the usual recursion, and
/// without its cases. Cost: about 0.3 us a step, 3-15 steps.

#include "tactum/collision/feature_walk.h"
#include "tactum/collision/pair_view.h"

namespace tactum::inline v0_1 {

/// Sets the closest points in `x`, with the lowest features they lie on; or returns kOverlap with a common
/// point, and its proof in `proof`.
FeatureWalk closest_by_supports(const PairView& pair, OverlapProof& proof, PairDistance& x) noexcept;

}  // namespace tactum::inline v0_1
