#pragma once
/// Bodies that rest cost nothing. While the budget is ample a body sleeps, at no velocity and without a
/// contact force to be found, when no motion of it could be seen or felt: it and everything that it touches,
/// directly or through others, has not moved for kStill_s. It wakes in the frame in which a contact comes or
/// goes, or the grasped part or a moving body touches its island. Patches are found before gaps close, so it
/// is awake before an impact on it. Where the budget is short another rule holds, see waiting.h.

#include "tactum/response/constraint_state.h"

namespace tactum::inline v0_1 {

/// Puts bodies to rest that may sleep (Waiting::waits), after the pairs have been tested.
void let_sleep(ConstraintStep& step) noexcept;

/// Wakes all bodies.
void wake(Sleep& sleep) noexcept;

}  // namespace tactum::inline v0_1
