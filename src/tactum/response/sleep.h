#pragma once
/// Bodies that rest cost nothing. While the budget is ample a body sleeps, at no velocity and without a
/// contact force to be found, when nothing of it could be seen or felt to move: it and everything that it
/// touches, directly or through others, has gone nowhere for kStill_s. It wakes with the frame in which a
/// contact comes or goes, or something restless touches its island: the held part, or what moves. Patches are
/// found before anything closes, so it is awake when it is struck. Where the budget is short another rule
/// holds, see waiting.h.

#include "tactum/response/constraint_state.h"

namespace tactum::inline v0_1 {

/// Puts those to rest that may sleep (Waiting::waits), after the pairs have been tested.
void let_sleep(ConstraintStep& step) noexcept;

/// Everything is awake.
void wake(Sleep& sleep) noexcept;

}  // namespace tactum::inline v0_1
