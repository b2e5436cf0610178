#pragma once
/// Contacts that move on without a step, for a response that shows their force to a hand frame by frame.
///
/// The shortest way out of an overlap switches from one facet to another, and a rocking face touches now at
/// one edge and now at the other; both answers are right and the hand would feel the step between them. Here
/// the answer of the last frame is kept and moves over to the new one at a bounded rate:
///
///     normal     turns by at most kNormalTurnRate, on the great circle, so it arrives within
///                pi / kNormalTurnRate = 63 ms; the depth along it is that of true support planes, so moving
///                A by it separates at every frame on the way
///     centroid   stays where both bodies carry it, and moves from there at kCentroidSpeed at most
///
/// A thin piece pushed right through another has no way round: every normal between is far deeper than both.
/// Then the normal switches at once. Cost: 40 ns while nothing is limited.

#include <cmath>

#include "tactum/collision/contact.h"
#include "tactum/geometry/polytope.h"

namespace tactum::inline v0_1 {

inline constexpr double kNormalTurnRate = 50.0;  ///< [rad/s]
inline constexpr double kCentroidSpeed = 0.05;   ///< [m/s]
inline constexpr double kDeepestDetour = 2.0;    ///< a normal on the way may be this many times as deep [-]

/// How far a contact moves over in one frame.
struct SteadyLimits {
  /// With `dt_s` from frame to frame [s].
  explicit SteadyLimits(double dt_s)
      : turn_rad(kNormalTurnRate * dt_s),
        cosine(std::cos(turn_rad)),
        sine(std::sin(turn_rad)),
        step_m(kCentroidSpeed * dt_s) {}

  double turn_rad;      ///< of the normal [rad]
  double cosine, sine;  ///< of that angle [-]
  double step_m;        ///< of the centroid [m]
};

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
                          const SteadyLimits& limits, SteadyContact& last) noexcept;

/// Moves the points of `patch` together, in its plane, so that their centroid takes no step. Between two
/// frames it moves, in A's frame, by at most the limit and half of B's own motion there. An empty patch
/// forgets.
void steady_centroid(const Pose& X_AB, Manifold& patch, const SteadyLimits& limits,
                     SteadyContact& last) noexcept;

}  // namespace tactum::inline v0_1
