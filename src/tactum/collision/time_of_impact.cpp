#include "tactum/collision/time_of_impact.h"

#include <algorithm>
#include <cmath>

#include "tactum/base/tolerances.h"
#include "tactum/collision/closest_features.h"
#include "tactum/math/screw.h"

namespace tactum::inline v0_1 {
namespace {

/// One moving piece at the start of a step, in its own frame.
struct MovingPiece {
  const Polytope& P;
  Vec3 n;          ///< the normal now
  Vec3 turning;    ///< n x w
  double curving;  ///< w^2 rho / 2: how fast a point can leave its tangent [m/s^2]
  int support = 0;

  MovingPiece(const Polytope& piece, const Pose& X_W, const Twist& V_W, const Vec3& n_W) noexcept
      : P(piece), n(X_W.R.transpose() * n_W) {
    const Vec3 w = X_W.R.transpose() * V_W.w;
    turning = n.cross(w);
    const double speed_sq = w.squaredNorm();
    // The piece lies in a ball about its center; the axis goes through the origin.
    const double off_axis = speed_sq > 0.0 ? w.cross(P.extent.center).norm() / std::sqrt(speed_sq) : 0.0;
    curving = 0.5 * speed_sq * (off_axis + P.extent.radius);
    support = table_vertex(P, n);
  }

  /// Lowest (`sign` = -1) or highest (+1) linear height of the turning piece after `t`.
  double height(double t, double sign) noexcept {
    const Vec3 direction = n + turning * t;
    support = support_vertex(P, sign * direction, support);
    return direction.dot(P.vertices[support]);
  }
};

/// The concave lower bound L(t) on the gap along the normal.
struct GapBound {
  MovingPiece a, b;
  double start;    ///< n . (p_WA - p_WB)
  double opening;  ///< n . (v_A - v_B)

  double operator()(double t) noexcept {
    return start + opening * t + a.height(t, -1.0) - b.height(t, 1.0) - (a.curving + b.curving) * t * t;
  }
};

/// A time in [0, rest] up to which the bound stays above `target`; it starts above by `room`. Halving brings
/// the far end closer, and the chord, which lies below a concave function, the near end.
double free_time(GapBound& bound, double room, double target, double rest) noexcept {
  constexpr int kRounds = 6;
  double beyond = rest;
  double over = bound(beyond) - target;
  if (over >= 0.0) return rest;
  double free = 0.0;
  for (int i = 0; i < kRounds; ++i) {
    const double chord = free + (beyond - free) * room / (room - over);
    if (const double at_chord = bound(chord) - target; at_chord > 0.0) {
      free = chord;
      room = at_chord;
    }
    const double middle = 0.5 * (free + beyond);
    const double at_middle = bound(middle) - target;
    if (at_middle > 0.0) {
      free = middle;
      room = at_middle;
    } else {
      beyond = middle;
      over = at_middle;
    }
  }
  return free;
}

}  // namespace

TimeOfImpact time_of_impact(const Polytope& A, const Pose& X_WA, const Twist& V_WA, const Polytope& B,
                            const Pose& X_WB, const Twist& V_WB, double dt, double target, PairCache& cache,
                            int most_steps) noexcept {
  const double tolerance = tolerances::kImpactGap * std::max(A.extent.size, B.extent.size);
  TimeOfImpact impact;
  for (impact.steps = 1; impact.steps <= most_steps; ++impact.steps) {
    const Pose X_WA_now = advanced(X_WA, V_WA, impact.time);
    const Pose X_WB_now = advanced(X_WB, V_WB, impact.time);
    impact.closest = closest_features(A, B, relative_pose(X_WA_now, X_WB_now), cache);
    const double room = impact.closest.distance - target;
    if (room <= tolerance) {
      // Above the target by less than the tolerance counts as a hit even at the start: there is no room to
      // move.
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
    GapBound bound{{A, X_WA_now, V_WA, n},
                   {B, X_WB_now, V_WB, n},
                   n.dot(X_WA_now.p - X_WB_now.p),
                   n.dot(V_WA.v - V_WB.v)};
    // A quarter of the tolerance is kept back for rounding.
    const double keep = 0.25 * tolerance;
    impact.time += free_time(bound, room - keep, target + keep, dt - impact.time);
  }
  --impact.steps;
  return impact;
}

}  // namespace tactum::inline v0_1
