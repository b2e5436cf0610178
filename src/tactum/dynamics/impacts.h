#pragma once
/// Impacts: momentum that bodies exchange in no time [Mirtich 1996b]. One pair of bodies is solved after the
/// other, the fastest approach first, until none approaches faster than resting bodies do. So an impact
/// travels through a row of touching balls as through Newton's cradle; solved all at once, the contacts would
/// divide it among them.
///
/// Within a pair all its corners are solved together: vn after >= -e vn before, impulses >= 0, with Coulomb's
/// friction for each pair of surfaces; a box that falls flat on its face leaves flat. All fixed bodies are
/// one, the world: on two rails a box leaves as flat as on one floor. It is the contact problem of two bodies
/// with velocities for displacements, and is solved exactly: the order of corners has no effect.

#include <span>

#include "tactum/dynamics/solve_exactly.h"
#include "tactum/dynamics/world.h"

namespace tactum::inline v0_1 {

/// Approach slower than this is rest, not impact: a few frames' worth of gravity [m/s].
inline constexpr double kImpactSpeed = 0.03;

/// Receives the impulses between the two bodies of every pair that is hit.
class ImpactObserver {
 public:
  virtual ~ImpactObserver() = default;
  /// `impulse` [N s] at `p_W` and `turning` [N m s] beside it act on body_a, their opposites on body_b.
  virtual void hit(int body_a, int body_b, const Vec3& impulse, const Vec3& turning,
                   const Vec3& p_W) noexcept = 0;
};

/// The bodies of a world, and the mark of those that an impact moves; an entry per body.
struct ImpactBodies {
  const World& world;
  std::span<const Pose> X_WB;
  std::span<const char> moves;
  std::span<Twist> V_WB;
};

struct ImpactResult {
  int hits = 0;           ///< pairs that were hit
  bool converged = true;  ///< false: the impulses of some pair are not exact, or pairs were left
};

/// Working memory of resolve_impacts().
struct ImpactScratch {
  explicit ImpactScratch(std::size_t bodies) : problem(kMostCorners, bodies, 2) {}
  /// Corners of one pair that are solved together; of more, the first ones.
  static constexpr std::size_t kMostCorners = 32;

  ContactProblem problem;
  FrictionAnchors no_anchors{0};
  Friction friction;
};

/// Changes the twists of the bodies that hit each other within the next `h` seconds, from rows with distances
/// at their start; leaves the rows' impulses as they were and marks the fastest corner of every pair that was
/// hit. At most `most` pairs are hit. `observer` may be null.
ImpactResult resolve_impacts(std::span<ContactRow> rows, const ImpactBodies& bodies, double h, int most,
                             ImpactScratch& scratch, ImpactObserver* observer) noexcept;

}  // namespace tactum::inline v0_1
