#pragma once
/// The bodies that move by themselves, in the constraint response: they fall, hit, slide and rest, and
/// penetrate nothing.
///
///     half of weight and load -> impacts -> the other half -> resting contact -> step on trial -> exact gaps
///                                                                    ^                                 |
///                                                                    '---- corrected, or halved <------'
///
/// A body's velocity is that of the middle of the frame, so that it falls on the exact parabola and a ball
/// that bounces without loss keeps its energy; impacts are solved with the velocity at the beginning of the
/// frame. Islands of bodies that touch are solved apart from each other (dynamics/islands.h), so that a jam
/// in one corner does not stop the rest. The island of the grasped part is the problem of constraint.h, whose
/// answer is exact, as long as there is room for it; otherwise it is solved here like the others.

#include "tactum/response/constraint_state.h"

namespace tactum::inline v0_1 {

/// In the penalty response the bodies move by the same rules; the grasped part's contacts then push them as
/// springs, between the two halves of what follows (penalty_response.h).

/// Takes half a frame of weight and load (body_load.h) from the initial velocities of a world.
void begin_midway(const World& world, double dt_s, WorldState& state) noexcept;

/// Adds the effect of weight and load up to the beginning of the frame.
void pull_free_bodies(const MotionInput& input, WorldState& bodies) noexcept;

/// Whether any body but the grasped ones moves.
bool others_move(const World& world, std::span<const HandInput> hands) noexcept;

/// Begins the step of all bodies: which are deferred, the islands, the contact rows, impacts, and the other
/// half of weight and load. Afterwards every body that is not grasped has the velocity that it keeps when no
/// contact holds it.
void begin_step(ConstraintStep& step) noexcept;

/// Moves all islands but `grasped_island`.
void move_free_bodies(ConstraintStep& step) noexcept;

/// Ends the step: the rates of the bodies that turn freely, at the end of the frame, from their mean ones,
/// and what is kept for the next frame. `as_forced`: the grasped part's island went where its contact forces
/// would have it.
void end_step(bool as_forced, ConstraintStep& step) noexcept;

}  // namespace tactum::inline v0_1
