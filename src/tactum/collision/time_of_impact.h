#pragma once
/// When two moving convex pieces first come as near as a target distance, rotation included, by conservative
/// advancement [Mirtich 1996; Zhang, Lee and Kim 2006].
///
///   Each piece moves as advanced(X, V, t) of math/screw.h: its origin on a line, turning about it at constant rate.
///   With n the normal and d the distance now, the gap along n closes no faster than
///        mu = n . (v_B - v_A) + |n x w_A| r_A + |n x w_B| r_B       r: largest distance of a point from the origin
///   so for (d - target) / mu seconds the distance stays above the target: go there and ask again.
///
/// A time it returns is never beyond the first contact. Cost: a warm distance query a step; 3-15 steps.

#include "tactum/collision/contact.h"
#include "tactum/geometry/polytope.h"
#include "tactum/math/spatial.h"

namespace tactum {

enum class ImpactStatus : std::uint8_t {
  kHit,            ///< at `time` the distance is the target, up to kImpactGap of the size above it
  kMiss,           ///< stays above the target for the whole time
  kStartedInside,  ///< at or below the target from the start: time is 0
  kBounded,        ///< out of steps, or an answer was not certified: free up to `time`, not known beyond
};

struct TimeOfImpact {
  ImpactStatus status = ImpactStatus::kBounded;
  double time = 0.0;     ///< nothing is nearer than the target before this [s]
  PairDistance closest;  ///< at `time`, in A's frame there
  int steps = 0;         ///< distance queries
};

/// First time in [0, dt] when the distance is `target` [m] or less. `target` should be above zero (a skin): at zero the
/// normal of the last step comes from touching features.
TimeOfImpact time_of_impact(const Polytope& A, const Pose& X_WA, const Twist& V_WA, const Polytope& B, const Pose& X_WB,
                            const Twist& V_WB, double dt, double target, PairCache& cache) noexcept;

}  // namespace tactum
