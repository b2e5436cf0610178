#pragma once
/// Contacts that move on without a step, for a response that shows their force to a hand frame by frame.
///
/// The shortest way out of an overlap switches from one facet to another, and a rocking face touches now at
/// one edge and now at the other; both answers are right and the hand would feel the step between them. Here
/// the answer of the last frame is kept and moves over to the new one at a bounded rate:
///
///     normal     turns by at most kNormalTurn a frame, on the great circle, so it arrives within
///                pi / kNormalTurn = 63 frames; the depth along it is that of true support planes, so moving
///                A by it separates at every frame on the way
///     centroid   stays where both bodies carry it, and moves from there by at most kCentroidStep a frame
///
/// A thin piece pushed right through another has no way round: every normal between is far deeper than both.
/// Then the normal switches at once. Cost: 40 ns while nothing is limited.

#include "tactum/collision/contact.h"
#include "tactum/geometry/polytope.h"

namespace tactum {

inline constexpr double kNormalTurn = 0.05;    ///< [rad] a frame
inline constexpr double kCentroidStep = 5e-5;  ///< [m] a frame
inline constexpr double kDeepestDetour = 2.0;  ///< a normal on the way may be this many times as deep [-]

/// What was shown in the last frame. Value-initialised means nothing.
struct SteadyContact {
  Vec3 normal_A = Vec3::Zero();    ///< from B to A, A's frame; zero: none
  Vec3 centroid_A = Vec3::Zero();  ///< of the patch, as A carries it [m]
  Vec3 centroid_B = Vec3::Zero();  ///< as B carries it, B's frame [m]
  bool has_centroid = false;
};

/// The overlap `found` as it is to be shown: itself while its normal is near the last, else the depth along a
/// normal on the way there. Without an overlap the memory follows.
PairDistance steady_depth(const Polytope& A, const Polytope& B, const Pose& X_AB, const PairDistance& found,
                          SteadyContact& last) noexcept;

/// Moves the points of `patch` together, in its plane, so that their centroid takes no step. Between two
/// frames it moves, in A's frame, by at most kCentroidStep and half of B's own motion there. An empty patch
/// forgets.
void steady_centroid(const Pose& X_AB, Manifold& patch, SteadyContact& last) noexcept;

}  // namespace tactum
