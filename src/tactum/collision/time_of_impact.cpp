#include "tactum/collision/time_of_impact.h"

#include <algorithm>

#include "tactum/base/tolerances.h"
#include "tactum/collision/closest_features.h"
#include "tactum/math/screw.h"

namespace tactum {
namespace {

/// Largest distance of a point of the piece from the origin of its frame, about which it turns.
double reach(const Polytope& P) noexcept { return P.center.norm() + P.radius; }

}  // namespace

TimeOfImpact time_of_impact(const Polytope& A, const Pose& X_WA, const Twist& V_WA, const Polytope& B, const Pose& X_WB,
                            const Twist& V_WB, double dt, double target, PairCache& cache) noexcept {
  constexpr int kSteps = 64;
  const double tolerance = tolerances::kImpactGap * std::max(A.size, B.size);
  TimeOfImpact impact;
  for (impact.steps = 1; impact.steps <= kSteps; ++impact.steps) {
    const Pose X_WA_now = advanced(X_WA, V_WA, impact.time);
    const Pose X_WB_now = advanced(X_WB, V_WB, impact.time);
    impact.closest = closest_features(A, B, relative_pose(X_WA_now, X_WB_now), cache);
    const double room = impact.closest.distance - target;
    if (room <= tolerance) {
      // Above the target by less than the tolerance counts as a hit even at the start: there is no room to move.
      const bool inside = impact.steps == 1 && room <= 0.0;
      impact.status = inside ? ImpactStatus::kStartedInside : ImpactStatus::kHit;
      return impact;
    }
    if (!impact.closest.certified()) return impact;
    if (impact.time >= dt) {
      impact.status = ImpactStatus::kMiss;
      return impact;
    }
    const Vec3 n = X_WA_now.R * impact.closest.normal;
    const double closing =
        n.dot(V_WB.v - V_WA.v) + n.cross(V_WA.w).norm() * reach(A) + n.cross(V_WB.w).norm() * reach(B);
    // Half the tolerance is kept back for the rounding of the poses.
    const double safe = closing > 0.0 ? (room - 0.5 * tolerance) / closing : dt;
    impact.time = std::min(dt, impact.time + safe);
  }
  --impact.steps;
  return impact;
}

}  // namespace tactum
