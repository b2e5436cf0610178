#pragma once
/// Contacts that move without a step, for a response that displays their force to a hand frame by frame.
///
/// The direction of least penetration depth switches from one facet to another, and a rocking face touches
/// now at one edge and now at the other; both answers are right and the hand would feel the step between
/// them. Here the answer of the last frame is kept and moves to the new one at a bounded rate:
///
///     normal     turns by at most kNormalTurnRate from where A or B carries the last one, whichever is
///                nearer, on the great circle, so it arrives within pi / kNormalTurnRate = 63 ms; the depth
///                along it is that of true support planes, so moving A by it separates the pieces in every
///                frame meanwhile
///     centroid   stays where both bodies carry it, and moves from there at kCentroidSpeed at most, times
///                the scale of the scene
///
/// A contact that pushes a body which no hand leads is not held back (SteadyLimits::none): a force beside
/// the place where the bodies touch would make energy in it.
///
/// For a thin piece pushed right through another there is no such path: every normal between is far deeper
/// than both. Then the normal switches at once. Cost: 40 ns while nothing is limited.

#include <cmath>
#include <limits>

#include "tactum/collision/contact.h"
#include "tactum/geometry/polytope.h"

namespace tactum::inline v0_1 {

inline constexpr double kNormalTurnRate = 50.0;  ///< [rad/s]
inline constexpr double kCentroidSpeed = 0.05;   ///< [m/s]
inline constexpr double kDeepestDetour = 2.0;    ///< how many times as deep a normal between may be [-]

/// How far a contact may move in one frame.
struct SteadyLimits {
  /// With `dt_s` from frame to frame [s], in a scene `scale` times as large as a hand's.
  explicit SteadyLimits(double dt_s, double scale = 1.0)
      : turn_rad(kNormalTurnRate * dt_s),
        cosine(std::cos(turn_rad)),
        sine(std::sin(turn_rad)),
        step_m(kCentroidSpeed * dt_s * scale) {}
  /// A contact is displayed as it was found.
  static SteadyLimits none() noexcept {
    SteadyLimits limits(0.0);
    limits.turn_rad = kPi;
    limits.cosine = -2.0;  // below any
    limits.step_m = std::numeric_limits<double>::infinity();
    return limits;
  }

  double turn_rad;      ///< of the normal [rad]
  double cosine, sine;  ///< of that angle [-]
  double step_m;        ///< of the centroid [m]
};

/// The contact of the last frame, as its force was computed (`shown` in the finder). Value-initialised: none.
struct SteadyContact {
  Vec3 normal_A = Vec3::Zero();    ///< from B to A, A's frame, as A carries it; zero: none
  Vec3 normal_B = Vec3::Zero();    ///< the same, B's frame, as B carries it
  Vec3 centroid_A = Vec3::Zero();  ///< of the patch, as A carries it [m]
  Vec3 centroid_B = Vec3::Zero();  ///< as B carries it, B's frame [m]
  bool has_centroid = false;
};

/// The overlap `found` as it is to be displayed: itself while its normal is near the last, else the depth
/// along a normal between the two. Without an overlap the memory is set to `found`.
PairDistance steady_depth(const Polytope& A, const Polytope& B, const Pose& X_AB, const PairDistance& found,
                          const SteadyLimits& limits, SteadyContact& last) noexcept;

/// Moves the points of `patch` together, in its plane, so that their centroid takes no step. Between two
/// frames it moves, in A's frame, by at most the limit and half of B's own motion there. With an empty patch
/// the memory is cleared.
void steady_centroid(const Pose& X_AB, Manifold& patch, const SteadyLimits& limits,
                     SteadyContact& last) noexcept;

}  // namespace tactum::inline v0_1
