#pragma once
/// The input of a response in every frame: the world, the grasped part and the pose of the hand, and the
/// contacts. Nothing here changes while the response works.

#include <span>
#include <vector>

#include "tactum/contact/contact_finder.h"
#include "tactum/contact/shading.h"
#include "tactum/dynamics/world.h"
#include "tactum/math/screw.h"
#include "tactum/response/settings.h"

namespace tactum::inline v0_1 {

/// The part that the hand holds, the pose of the probe, and the load of force fields on the part: what the
/// hand stage found in this frame. The functions of grasped_part.h work on it.
struct GraspedPart {
  bool hand_known = false;  ///< false until the first valid sample: nothing may move
  int body = -1;            ///< index into World::bodies; -1: nothing is grasped
  Pose X_BH;                ///< the handle in the grasped body's frame [m]
  Pose X_WH;                ///< the probe in the world [m]
  Twist V_WH;               ///< its velocity [m/s, rad/s]
  FollowedTurn turned_W;    ///< from the handle on the part to the hand, world axes
  bool in_field = false;    ///< force fields act on the grasped part
  FieldLoad field;          ///< their load at the pose the frame starts with
};

/// The handle on the grasped part.
struct PlacedHandle {
  Pose X_WH_proxy;  ///< where it is [m]
  Twist to_hand;    ///< displacement from there to the hand; its turn is followed over full turns [m, rad]
};

/// The handle with the part at X_WB.
inline PlacedHandle handle_at(const GraspedPart& grasped, const Pose& X_WB) {
  const Pose X_WH_proxy = X_WB * grasped.X_BH;
  return {X_WH_proxy,
          {grasped.X_WH.p - X_WH_proxy.p,
           followed_turn(grasped.X_WH.R * X_WH_proxy.R.transpose(), grasped.turned_W)}};
}

/// The input of a motion bound: everything that is known before contacts are looked for.
struct MotionInput {
  const World& world;
  const FrameSettings& settings;
  const GraspedPart& grasped;
  std::span<const double> radius_m;  ///< of each body: farthest point from its origin [m]
  double dt_s;                       ///< time from frame to frame [s]
};

struct StepInput : MotionInput {
  std::span<const ContactPatch> patches;       ///< found with the bodies at X_WB_start
  std::span<const std::uint8_t> priority;      ///< of each body (contact/schedule.h)
  const ContactWork& work;                     ///< what was tested, and what was left
  const std::vector<ShadingNormals>& shading;  ///< one per body; empty when shading is off
  std::span<const Pose> X_WB_start;            ///< poses at the start of the frame [m]
};

}  // namespace tactum::inline v0_1
