#pragma once
/// Who waits. When the frame cannot look at every pair, or at every pose on trial, some bodies stand still
/// for a frame: time stops for them, they keep their velocity and gravity does not pull them. What stands
/// still needs no look, and nothing can be entered by what does not move; so the budget costs time in the
/// scene, never penetration.
///
///   waits:  a body with a pair that was left unproven (contact_finder.h)
///           a body that the tests left for the poses on trial do not reach to; first come those that touch
///           the held part, then those that have waited longest
///
/// What waits carries nobody's load, so a heap whose bodies take turns would never come to rest. Therefore,
/// while the budget is not ample, a body that has hardly left its place in its last 60 ms sleeps: it
/// stands still, at no cost, until the held part or something fast touches it, or it has lost half of its
/// contacts. With an ample budget nothing waits, and only what nobody could see move sleeps (sleep.h).
///
/// How many tests a body will take is guessed from how far it went in its last frame: contacts whose gap that
/// does not halve are proven open without a test. Where the guess was too low, the step is cut
/// (free_bodies.h). The held part never waits: where one of its own pairs was left unproven, it goes nowhere
/// in that frame.

#include "tactum/response/constraint_state.h"

namespace tactum::inline v0_1 {

/// Chooses who waits, and puts them at rest. After the pairs have been tested.
void defer_bodies(ConstraintStep& step) noexcept;

/// Gives those that waited their velocities back.
void go_on(ConstraintStep& step) noexcept;

}  // namespace tactum::inline v0_1
