#pragma once
/// The walk to the closest features of two convex pieces [Lin and Canny 1991; Mirtich 1998].
///
/// The state is a pair of features. Closest points of the two features are tested against the Voronoi region
/// of the other feature; a point outside it determines the neighbour to go to. Where nothing is violated, the
/// pair is closest.
///
///     vertex-vertex  <->  vertex-edge  <->  vertex-face          (and the same with A and B exchanged)
///                            |                  |
///                         edge-edge   <->   edge-face  ->  overlap, when the edge goes through the face
///
/// A vertex that leaves a face goes to the face across the edge or to an end of the edge, where it belongs to
/// either, without a stop at the edge.
///
/// It differs from Mirtich's in edge-edge, where the place along both edges is computed, by dot products
/// where they cross at an angle and by cross products where they are nearly parallel (his clipping against
/// the four planes gives the same and rounds worse near parallel edges), and in its answer when rounding
/// makes the walk cycle: the nearest state of the cycle is returned and the caller's certificate judges it.
///
/// The walk's last tests are a proof. A vertex all of whose edges fall away from a plane is the support
/// vertex of a convex piece, an edge square to the plane whose two faces fall away is its support edge, a
/// face is its own: so the planes through the answer's features, square to its normal, separate the pieces by
/// the answer's distance. The error that rounding leaves is added up in `error_bound`. Cost: 15-25 ns a step;
/// one step when the features of the last frame still hold.

#include "tactum/collision/feature_walk.h"
#include "tactum/collision/pair_view.h"

namespace tactum::inline v0_1 {

/// Walks from the features `a`, `b` (which must exist) and sets in `x` the features where it ended, and
/// their points, normal and distance when it ended kClosest, kCircle or kBounded (the normal only when
/// closest); the stop and the steps of `x` are the caller's. `crossing_tolerance` [m] is how far a point
/// must be outside a plane to cross it.
FeatureWalk feature_walk(const PiecePair& pair, Feature a, Feature b, double crossing_tolerance,
                         PairDistance& x) noexcept;

}  // namespace tactum::inline v0_1
