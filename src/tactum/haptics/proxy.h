#pragma once
/// How the held part's proxy wants to move: straight to where the hand holds it, but no farther in one frame than
/// the safe threshold distance [Gregory 2000, 3.2]: the tolerance of contact determination grows with
/// the speed, so what cannot travel farther cannot slip past what it was tested against.

#include "tactum/dynamics/world.h"
#include "tactum/haptics/settings.h"

namespace tactum {

/// The velocity that takes the held body to the hand in `dt_s`, scaled down so that no point of it (within
/// `radius` [m] of its origin) moves more than `max_step_m`.
Twist velocity_to_hand(const Tool& tool, const Pose& X_WB, const Pose& X_WH, double radius, double max_step_m,
                       double dt_s) noexcept;

}  // namespace tactum
