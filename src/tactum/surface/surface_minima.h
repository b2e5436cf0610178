#pragma once
/// Surface against surface: all local minima of distance within a tolerance. A contact needs no more than
/// them: of the tens of thousands of triangle pairs near each other on a nut and a bolt, some thousand pairs
/// of features are minima.
///
/// A pair of features is a minimum where the segment between its nearest points lies in both normal cones
/// (surface_tree.h): moved a little along either surface, it only gets longer.
///
///        \  A  /         vertex - face        __A__/  \__        edge - edge: n is square to both
///         \ | /          n is the face's           |n           and inside both cones
///          \|/           own normal           ____/ \____
///           * p_a                                 B
///           | n                               vertex - edge, vertex - vertex: n is along p_a - p_b
///      -----*-----  B
///           p_b
///
/// Distances of vertex - face and edge - edge pairs are signed: a vertex slightly behind a face, or two edges
/// that have slightly crossed, is a minimum below zero, down to `depth`. Surfaces without a negative minimum
/// do not cross, as long as they have moved by less than `depth` since they did not; `depth` must be smaller
/// than the thinnest wall.
///
/// Cones are inflated by `cone_inflation`, the largest rotation of a step. Without it only the lowest corner
/// of a flat contact is a minimum, and the contact sticks; with it, all corners of either that face the
/// other, and the crossings of their outlines. `strict` marks minima that hold without it: only those are for
/// validation. Outside its true cone the sign of an edge pair means nothing: one that is not strict is a
/// constraint while it is apart, and is left out below zero.
///
/// Edges parallel to within the inflation touch along an interval: the two ends of it are two minima of the
/// same features.
///
/// Stateless: the same bits for the same poses, whatever the queries before. No allocation, no locks. Cost
/// and what was tried: docs/algorithms/surface_minima.md.

#include <vector>

#include "tactum/geometry/surface_tree.h"
#include "tactum/math/pose.h"
#include "tactum/surface/surface_minimum.h"

namespace tactum::inline v0_1 {

/// The minima of A and B with B at X_AB, sorted by the features of A, then of B. `minima` is cleared and
/// filled up to its capacity, which is never raised: reserve it at load time. When more are found the nearest
/// are kept.
MinimaWork surface_minima(const SurfaceTree& a, const SurfaceTree& b, const Pose& X_AB,
                          const MinimaQuery& query, std::vector<SurfaceMinimum>& minima) noexcept;

/// A lower bound of the surfaces' distance up to `max_distance`: their distance, too short by up to a tenth,
/// or `max_distance` where that is nearer; 0 where there is a minimum below zero. Each minimum found narrows
/// the search, so it costs about as much as the minima within the distance.
double surface_clearance(const SurfaceTree& a, const SurfaceTree& b, const Pose& X_AB,
                         const MinimaQuery& query, MinimaWork& work) noexcept;

namespace lanes {
struct Kernels;
/// The same with these tests (surface_minima_lanes.h) instead of the best the processor has: for comparisons.
MinimaWork surface_minima(const Kernels& kernels, const SurfaceTree& a, const SurfaceTree& b,
                          const Pose& X_AB, const MinimaQuery& query,
                          std::vector<SurfaceMinimum>& minima) noexcept;
}  // namespace lanes

}  // namespace tactum::inline v0_1
