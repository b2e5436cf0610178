#pragma once
/// Whether two convex pieces stay apart all along a motion, turns included, not only at its ends.
///
/// The search of path_search.h with supports along the normals of the closest features. Gaps are those of
/// supports, so a distance that was not certified proves nothing false.

#include "tactum/collision/contact.h"
#include "tactum/geometry/polytope.h"
#include "tactum/math/relative_motion.h"

namespace tactum::inline v0_1 {

/// The fraction of the motion up to which the pieces are apart, in [0, 1]; 0 where they touch at its start.
/// `cache` is the pair's (closest_features.h); a copy of it is changed.
double convex_path_free(const Polytope& A, const Polytope& B, const RelativeMotion& motion,
                        const PairCache& cache) noexcept;

}  // namespace tactum::inline v0_1
