#pragma once
/// Grasping and releasing with the device's primary button. While it is pressed, the hand holds the body that
/// was nearest to the handle when it was pressed; where in the body, and in which orientation, stays as it
/// was in that moment, so nothing is pulled and no force steps. A hinged gear grasped at its rim is so turned
/// like a wheel by its spoke, grasped at its middle by the torque of the wrist alone [Gregory 2000, 6.2]. A
/// body that is released keeps the velocity it had: it is thrown.

#include <span>

#include "tactum/dynamics/world.h"
#include "tactum/response/settings.h"

namespace tactum::inline v0_1 {

/// The body that moves and is nearest to a point of the world, and no farther than `pick_distance_m`; -1 when
/// there is none. The distance is to the nearest plane of the nearest convex piece, so it is short beside
/// edges; of a part without pieces, to its nearest vertex. Cost: linear in faces, when the button is pressed.
int nearest_body(const World& world, std::span<const Pose> X_WB, const Vec3& p_W,
                 double pick_distance_m) noexcept;

/// The grasp of the hand.
struct Grasp {
  int body = -1;         ///< index into World::bodies; -1: nothing
  Pose X_BH;             ///< the handle in the grasped body's frame [m]
  bool pressed = false;  ///< the primary button was pressed in the last frame
};

/// Grasps or releases when the button has been pressed or released since the last frame. `X_WH` is the probe.
void pick_or_release(const World& world, std::span<const Pose> X_WB, const Tool& tool, const Pose& X_WH,
                     std::uint32_t buttons, Grasp& grasp) noexcept;

}  // namespace tactum::inline v0_1
