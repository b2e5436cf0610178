#pragma once
/// Grasping and releasing with the device's primary button. While it is pressed, the hand holds the body that
/// was nearest to the handle when it was pressed; where in the body, and in which orientation, stays as it
/// was in that moment, so nothing is pulled and no force steps. A body that is released keeps the velocity it
/// had: it is thrown.
///
/// A hinged body can be held in two ways, and the place decides [Gregory 2000, 6.2], where the settings put
/// it into the hand as well as where it is picked. Near its axis the probe becomes the body: the body turns
/// with the hand about the axis, is felt by its torque alone, and wherever the hand is led it turns nothing.
/// Elsewhere the hand holds it as a rod in a wheel: it turns as the hand is led round the axis, and is felt
/// by force; the turn of the hand itself about the axis makes no difference. In both ways the coupling holds
/// the hand where the body allows no motion.

#include <span>

#include "tactum/dynamics/world.h"
#include "tactum/response/settings.h"
#include "tactum/response/step_input.h"

namespace tactum::inline v0_1 {

/// The body that moves and is nearest to a point of the world, and no farther than `pick_distance_m`; -1 when
/// there is none. The distance is to the nearest plane of the nearest convex piece, so it is short beside
/// edges; of a part without pieces, to its nearest vertex. Cost: linear in faces, when the button is pressed.
int nearest_body(const World& world, std::span<const Pose> X_WB, const Vec3& p_W,
                 double pick_distance_m) noexcept;

/// The grasp of the hand.
struct Grasp {
  int body = -1;  ///< index into World::bodies; -1: nothing
  Pose X_BH;      ///< the handle in the grasped body's frame; on the axis for Hold::kCentre [m]
  Hold hold = Hold::kFirm;
  Vec3 beside_W = Vec3::Zero();  ///< from the handle to where the hand took it, for Hold::kCentre [m]
  bool pressed = false;          ///< the primary button was pressed in the last frame
  /// Of a hand that lets go of a part that another hand holds on to: how much of its coupling is left. It
  /// goes to nothing within kHandOver_s, so that the other hand takes the weight over without a step [-].
  double left = 1.0;
};

/// How long a hand takes to leave a part to another hand [s].
inline constexpr double kHandOver_s = 0.25;

/// Takes hold of the body where the hand is: sets where it is held, and how. Cost: linear in the part's
/// vertices.
void take(const Body& body, const Pose& X_WB, double centre_fraction, const Pose& X_WH,
          Grasp& grasp) noexcept;

/// Grasps or releases when the button has been pressed or released since the last frame. `X_WH` is the probe.
void pick_or_release(const World& world, std::span<const Pose> X_WB, const Tool& tool, const Pose& X_WH,
                     std::uint32_t buttons, Grasp& grasp) noexcept;

}  // namespace tactum::inline v0_1
