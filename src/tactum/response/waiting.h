#pragma once
/// Which bodies are deferred. When the budget does not cover every pair, or every trial pose, some bodies
/// stand still for a frame: they keep their velocity, and gravity does not pull them. A pair of bodies that
/// stand still needs no test and cannot come to penetrate; so a short budget costs time in the scene, never
/// penetration.
///
///   deferred:  a body with a pair that was left unproven, or that found no memory (contact_finder.h)
///              a body that the tests left for trial poses do not cover; the bodies that touch the
///              grasped part come first, then those that have been deferred longest
///
/// A deferred body carries no load, so a heap whose bodies take turns would never come to rest. Therefore,
/// while the budget is not ample, a body that has hardly moved in its last 60 ms sleeps: it stands still, at
/// no cost, until the grasped part or something fast touches it, or it has lost half of its contacts. With an
/// ample budget no body is deferred, and a body sleeps only when its motion could not be seen (sleep.h).
///
/// How many tests a body will take is estimated from how far it went in its last frame: contacts whose gap
/// does not halve by that are proven open without a test. Where the estimate was too low, the step is cut
/// (free_bodies.h). The grasped part is never deferred: where one of its own pairs was left unproven, it
/// stays in that frame.

#include "tactum/response/constraint_state.h"

namespace tactum::inline v0_1 {

/// Chooses the bodies to be deferred, and sets their velocities to zero. After the pairs have been tested.
void defer_bodies(ConstraintStep& step) noexcept;

/// Gives the deferred bodies their velocities back.
void go_on(ConstraintStep& step) noexcept;

}  // namespace tactum::inline v0_1
