#pragma once
/// A contact point of two bodies as every solver takes it, and the outcome of a solution.

#include <cmath>
#include <cstddef>
#include <span>

#include "tactum/math/types.h"

namespace tactum::inline v0_1 {

/// The surfaces of two bodies that touch, by groups of coplanar faces that their parts number. The corners
/// and edges of one body that touch the same face of the other are on one pair of surfaces, whatever faces
/// they belong to: kAnyGroup.
struct SurfacePair {
  int body_a = -1, body_b = -1, group_a = -1, group_b = -1;
  bool fixed_a = false, fixed_b = false;  ///< the body does not move: all that do not are one, the world
  bool operator==(const SurfacePair&) const = default;
};

inline constexpr int kAnyGroup = -1;

/// Whether the same bodies touch, in the same order; all fixed bodies are the same.
inline bool same_bodies(const SurfacePair& p, const SurfacePair& q) noexcept {
  return p.fixed_a == q.fixed_a && p.fixed_b == q.fixed_b && (p.fixed_a || p.body_a == q.body_a) &&
         (p.fixed_b || p.body_b == q.body_b);
}

/// The parameters of an impact at a point.
struct ImpactLaw {
  double restitution = 0.0;  ///< fraction of the speed that is left [-]
  bool enabled = true;       ///< takes part in impacts
  bool seen = false;         ///< the impact of the pair was found at this point, in this frame
};

/// One contact point between two bodies: normal from B to A, as in collision/contact.h, in world axes.
struct ContactRow : SurfacePair {
  const SurfacePair& surfaces() const noexcept { return *this; }
  /// The surfaces whose friction patch it belongs to.
  const SurfacePair& friction_surfaces() const noexcept { return plane.body_a < 0 ? *this : plane; }

  /// The surfaces that stand for all in this row's plane (friction_planes.h); without bodies: its own.
  SurfacePair plane;
  int patch = -1;              ///< the caller's number of its patch; solvers ignore it
  int friction_patch = -1;     ///< the caller's number of its friction patch; solvers ignore it
  int state = -1;              ///< number of its state in RowMemory; -1: none is kept
  Vec3 n_BA_W = Vec3::Zero();  ///< unit [-]
  Vec3 p_W = Vec3::Zero();     ///< where the force acts, halfway between the two surfaces [m]
  double distance = 0.0;       ///< signed, at the start of the step [m]
  double skin_m = 0.0;         ///< the gap at which the pair's contacts are kept [m]
  double asked = 0.0;          ///< by how much the step has to open it at least; negative: it may close [m]
  bool idle = false;           ///< implied by others, or passed by: asks nothing until a trial closes it
  bool rolls = false;          ///< of a curved surface: in every frame other points of the bodies touch
  double friction = 0.0;       ///< Coulomb's coefficient [-]
  double margin = 0.0;         ///< delta, the contact margin of the pair [m]
  double stiffness = 0.0;      ///< k of the penalty law, the point's part of it; for rows that yield [N/m]
  ImpactLaw impact;
  double impulse = 0.0;  ///< along the normal, the answer [N s]

  /// What is carried from frame to frame (carried_state.h).
  template <class Self, class Visit>
  static void carried(Self& self, Visit& visit) noexcept {
    visit(self.body_a, self.body_b, self.group_a, self.group_b, self.fixed_a, self.fixed_b, self.plane,
          self.patch, self.friction_patch, self.state, self.n_BA_W, self.p_W, self.distance, self.skin_m,
          self.asked, self.idle, self.rolls, self.friction, self.margin, self.stiffness, self.impact,
          self.impulse);
  }
};

/// The rows of contacts, and where the first of them stands in the problem.
struct RowsInProblem {
  std::span<const ContactRow> rows;
  std::size_t first = 0;

  /// The contact row with this number in the problem; null when it is none of them.
  const ContactRow* row(int number) const noexcept {
    const std::size_t at = static_cast<std::size_t>(number) - first;
    return static_cast<std::size_t>(number) >= first && at < rows.size() ? &rows[at] : nullptr;
  }
};

/// A lift, or a gap beyond the skin, below this many skins counts as zero.
inline constexpr double kSettledSkins = 0.25;
inline double settled_length(double skin_m) noexcept { return kSettledSkins * skin_m; }

/// The fraction that opens in a step of h seconds: a tenth in a millisecond.
inline double opening_share(double h) noexcept {
  constexpr double kOpening_s = 0.0095;
  return 1.0 - std::exp(-h / kOpening_s);
}

/// What an idle row asks: less than every step has to give [m].
inline constexpr double kAsksNothing_m = -1e3;

/// By how much a step has to open a row: its gap may close to the skin, or must open towards it [m].
inline double asked_of(const ContactRow& row, double opening_share) noexcept {
  if (row.idle) return kAsksNothing_m;
  const double missing = row.skin_m - row.distance;
  return missing > 0.0 ? opening_share * missing : missing;
}

/// The outcome of a search for forces.
struct SolverResult {
  int iterations = 0;      ///< sweeps, rounds of Newton's method, or changes of the active set
  bool converged = false;  ///< false: the iterations ran out; the forces are usable, not exact
};

}  // namespace tactum::inline v0_1
