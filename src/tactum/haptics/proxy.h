#pragma once
/// How the held part's proxy moves: straight to where the hand holds it, but no farther in one frame than the
/// safe threshold distance [Gregory 2000, 3.2]. The tolerance of contact determination grows with that
/// speed, so what moves towards the hand cannot slip past what it was tested against. (What contacts push it
/// back by is bounded by the threshold too, but first tested in the next frame.)
///
/// The threshold limits the step that is taken, not the pull that the contact forces are weighed against:
/// with the pull cut to the threshold a held gear could never push harder than the spring over half a
/// millimetre.

#include "tactum/dynamics/world.h"
#include "tactum/haptics/settings.h"

namespace tactum {

/// The velocity that takes the held body to where the hand has it, in `dt_s`.
Twist velocity_to_hand(const Tool& tool, const Pose& X_WB, const Pose& X_WH, double dt_s) noexcept;

/// V scaled down so that no point within `radius` [m] of the body's origin moves more than `max_step_m` in
/// `dt_s`.
Twist within_threshold(const Twist& V, double radius, double max_step_m, double dt_s) noexcept;

}  // namespace tactum
