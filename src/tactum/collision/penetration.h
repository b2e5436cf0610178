#pragma once
/// The penetration depth of two overlapping convex pieces: the shortest translation of A that separates them,
/// given as a negative distance along the contact normal (contact.h). Found by the walk of minkowski_walk.h.
///
/// Every depth is that of true support planes along the unit normal, so moving A by it always separates the
/// pieces. `certified` means that the facet of the Minkowski difference is real and holds its own foot: a
/// local minimum. It is surely the global one after penetration_exhaustive, and in a cold start when both
/// pieces are small.
/// pieces are small.

#include "tactum/collision/pair_view.h"

namespace tactum::inline v0_1 {

/// Begins with the last frame's features or normal when `cache` has them, with a search for a better minimum
/// spread over the frames beside; else with many directions, or all separating axes of small pieces. Cost:
/// 0.1 us warm, 2-20 us cold. For pieces that do not overlap: a separating axis, and a lower bound on their
/// distance.
PairDistance penetration_depth(const Polytope& A, const Polytope& B, const Pose& X_AB,
                               PairCache& cache) noexcept;

/// Begins with the last frame's features alone (`cache.normal_A` must not be zero): the first step of
/// penetration_depth. Not certified when the pieces have separated, or when the walk found no proof. Cost:
/// 0.1-0.2 us.
PairDistance tracked_depth(const PairView& pair, PairCache& cache) noexcept;

/// The global minimum, over every facet of the Minkowski difference. Not for the frame: E_A E_B x 10 ns (two
/// spheres of 642 vertices: 40 ms).
PairDistance penetration_exhaustive(const Polytope& A, const Polytope& B, const Pose& X_AB) noexcept;

/// The paper's depth: how far A must move along unit `direction` (A's frame) until it is clear of B, exactly;
/// as a negative distance, with the normal of the features that touch then, p_a and p_b touching after the
/// motion. Zero and `kBounded` when the motion never touches, NaN when pose or direction is not finite.
PairDistance depth_along(const Polytope& A, const Polytope& B, const Pose& X_AB,
                         const Vec3& direction) noexcept;

}  // namespace tactum::inline v0_1
