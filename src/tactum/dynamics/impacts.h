#pragma once
/// Impacts: momentum that bodies exchange in no time [Mirtich 1996b], each at its own time within the frame.
/// The pair of bodies that meets first is advanced to the time of its impact and solved there, then the next
/// one on the way it has from then on, until none is left that is faster than resting bodies are. So an
/// impact travels through a row of balls as through Newton's cradle; solved all at once, the contacts
/// would divide it among them.
///
/// Within a pair all corners that meet at that time are solved as one: vn after >= -e vn before, impulses
/// >= 0, with Coulomb's friction for each pair of surfaces; a box that falls on its face leaves flat. All
/// fixed bodies are one, the world: on two rails a box leaves as flat as on a floor. It is the contact
/// problem of two bodies with velocities for displacements, and is solved exactly: the order of corners has
/// no effect.
///
/// A body that is hit at time t moves with V_before until then, with V_after from then on. Its twist after
/// the frame's impacts is given at the start of the frame, as if it had always been V_after; what that leaves
/// out, (V_before - V_after) t, is its detour, which belongs to its displacement. With both a body that
/// bounces is on its exact parabola at the frame's end, wherever in the frame it was hit.
///
///        | v         What a body rests on holds it also while it is hit: the contacts that carried a body
///       [A]          in the last frame are solved together with the impact, without restitution of their
///      ======        own. So A leaves B, which lies on a floor, as it would leave the floor. A contact
///       [B]          carries a body where the body's contacts, all together, push it along the contact's
///    ==floor==       normal; two that merely touch, as in a cradle, pass the impact on.

#include <span>

#include "tactum/dynamics/solve_exactly.h"
#include "tactum/dynamics/world.h"

namespace tactum::inline v0_1 {

/// Receives the impulses between the two bodies of every pair that is hit.
class ImpactObserver {
 public:
  virtual ~ImpactObserver() = default;
  /// `impulse` [N s] at `p_W` and `turning` [N m s] beside it act on body_a, their opposites on body_b.
  virtual void hit(int body_a, int body_b, const Vec3& impulse, const Vec3& turning,
                   const Vec3& p_W) noexcept = 0;
};

/// The bodies of a world; an entry per body.
struct ImpactBodies {
  const World& world;
  std::span<const Pose> X_WB;   ///< at the start of the frame
  std::span<const char> moves;  ///< an impact moves the body
  /// What weight, load and resting contacts add to its twist in a second [m/s2, rad/s2].
  std::span<const Twist> A_WB;
  /// The part of it that is of resting contacts, as they were in the last frame [m/s2, rad/s2].
  std::span<const Twist> A_contacts;
  std::span<Twist> V_WB;    ///< at the start of the frame [m/s, rad/s]
  std::span<Twist> detour;  ///< displacement beside that of V_WB; zero where nothing was hit [m, rad]
};

/// The meeting of two surfaces at a contact point: they come as near as the skin.
struct Meeting {
  double time_s = 0.0;  ///< after the start of the frame; infinite when they do not meet
  double speed = 0.0;   ///< with which they approach then [m/s]
};

/// When a row meets, not before `now` seconds.
Meeting meeting_of(const ContactRow& row, const ImpactBodies& bodies, double now) noexcept;

/// Approach slower than this is rest, not impact, in frames of `h` seconds [m/s]. It is what bodies at rest
/// have: the weight of a frame and a half, and the opening of a gap by the skin.
double slowest_impact(const ContactRow& row, const ImpactBodies& bodies, double h) noexcept;

struct ImpactResult {
  int hits = 0;           ///< pairs that were hit
  bool converged = true;  ///< false: the impulses of some pair are not exact, or pairs were left
};

/// Working memory of resolve_impacts().
struct ImpactScratch {
  explicit ImpactScratch(std::size_t bodies) : problem(kMostCorners, bodies, kMostBodies) {}
  /// Bodies of one impact: the two that meet, and those that carry them, as far as there is room.
  static constexpr std::size_t kMostBodies = kMostUnknowns / 6;
  /// Corners of one impact that are solved together; of more, the first ones.
  static constexpr std::size_t kMostCorners = 64;

  ContactProblem problem;
  FrictionAnchors no_anchors{0};
  Friction friction;
};

/// Changes the twists and detours of the bodies that hit each other within the next `h` seconds, from rows
/// with distances at their start; leaves the rows' impulses as they were and marks the corner of every pair
/// that met first. At most `most` pairs are hit. `observer` may be null.
ImpactResult resolve_impacts(std::span<ContactRow> rows, const ImpactBodies& bodies, double h, int most,
                             ImpactScratch& scratch, ImpactObserver* observer) noexcept;

}  // namespace tactum::inline v0_1
