#pragma once
/// The input of a response in every frame: the world, the grasped part and the pose of the hand, and the
/// contacts. Nothing here changes while the response works.

#include <span>
#include <vector>

#include "tactum/contact/contact_finder.h"
#include "tactum/contact/shading.h"
#include "tactum/dynamics/world.h"
#include "tactum/math/screw.h"
#include "tactum/response/workspace_scale.h"

namespace tactum::inline v0_1 {

/// How the hand holds the grasped part.
enum class Hold {
  kFirm,    ///< every displacement and turn of the hand is passed on
  kCentre,  ///< of a hinged body, near its axis: the hand's place turns nothing, its turn about the axis does
  kRod  ///< of a hinged body, beside its axis: the hand's way round it turns it, its turn about it does not
};

/// The part that the hand holds, the pose of the probe, and the load of force fields on the part: what the
/// hand stage found in this frame. The functions of grasped_part.h work on it.
struct GraspedPart {
  bool hand_known = false;  ///< false until the first valid sample: nothing may move
  int body = -1;            ///< index into World::bodies; -1: nothing is grasped
  Pose X_BH;                ///< the handle in the grasped body's frame; on the axis for Hold::kCentre [m]
  Hold hold = Hold::kFirm;
  Vec3 axis_W = Vec3::Zero();    ///< of the hinge, for Hold::kRod; zero otherwise [-]
  Vec3 arm_W = Vec3::Zero();     ///< from that axis to the handle; zero otherwise [m]
  Vec3 beside_W = Vec3::Zero();  ///< from the handle to where the hand took it, for Hold::kCentre [m]
  Pose X_WH;                     ///< the probe in the world [m]
  Twist V_WH;                    ///< its velocity [m/s, rad/s]
  FollowedTurn turned_W;         ///< from the handle on the part to the hand, world axes
  bool in_field = false;         ///< force fields act on the grasped part
  FieldLoad field;               ///< their load at the pose the frame starts with
};

/// The part of a turn or torque that the coupling passes on: none about the axis of a rod.
inline Vec3 passed_on(const GraspedPart& grasped, const Vec3& about_W) {
  return about_W - grasped.axis_W * grasped.axis_W.dot(about_W);
}

/// The handle on the grasped part.
struct PlacedHandle {
  Pose X_WH_proxy;  ///< where it is [m]
  /// The displacement that the coupling sees, from there to the hand. Its turn is followed over full turns;
  /// that of a rod is what is left without the turn about the axis [m, rad].
  Twist to_hand;
};

/// The handle with the part at X_WB.
inline PlacedHandle handle_at(const GraspedPart& grasped, const Pose& X_WB) {
  const Pose X_WH_proxy = X_WB * grasped.X_BH;
  const Mat3 turn = grasped.X_WH.R * X_WH_proxy.R.transpose();
  return {X_WH_proxy,
          {grasped.X_WH.p - grasped.beside_W - X_WH_proxy.p, grasped.hold == Hold::kRod
                                                                 ? turn_aside(turn, grasped.axis_W)
                                                                 : followed_turn(turn, grasped.turned_W)}};
}

/// What a response knows of a hand.
struct HandInput {
  GraspedPart grasped;
  Coupling coupling;  ///< in the scene
  StepLimits limits;  ///< of the grasped part
  double left = 1.0;  ///< of the coupling, while the part is left to another hand (Grasp::left) [-]
  /// It is the first hand that holds the part: weight, load and damping of a part that several hold are
  /// counted once.
  bool bears_load = true;
};

/// Whether some hand holds a body.
inline bool is_grasped(std::span<const HandInput> hands, std::size_t body) noexcept {
  for (const HandInput& hand : hands)
    if (hand.grasped.body == static_cast<int>(body)) return true;
  return false;
}

/// How many hands hold a body.
inline int holders_of(std::span<const HandInput> hands, int body) noexcept {
  int holders = 0;
  for (const HandInput& hand : hands) holders += hand.grasped.body == body ? 1 : 0;
  return holders;
}

/// What a response knows of a hand that has found `grasped`. `share`: of the coupling's stiffness that the
/// port's energy balance leaves (loop/passivity.h); `left`: HandInput::left.
HandInput hand_input(const FrameSettings& settings, const HandSettings& hand, const GraspedPart& grasped,
                     std::span<const double> radius_m, double share, double left = 1.0) noexcept;

/// The input of a motion bound: everything that is known before contacts are looked for.
struct MotionInput {
  const World& world;
  const FrameSettings& settings;
  std::span<const HandInput> hands;  ///< at least one
  std::span<const double> radius_m;  ///< of each body: farthest point from its origin [m]
  double dt_s;                       ///< time from frame to frame [s]
  StepLimits limits;                 ///< of all grasped parts: the smallest of each
  double scale;                      ///< FrameSettings::smallest_scale() [-]
};

MotionInput motion_input(const World& world, const FrameSettings& settings, std::span<const HandInput> hands,
                         std::span<const double> radius_m) noexcept;

struct StepInput : MotionInput {
  std::span<const ContactPatch> patches;       ///< found with the bodies at X_WB_start
  std::span<const std::uint8_t> priority;      ///< of each body (contact/schedule.h)
  const ContactWork& work;                     ///< what was tested, and what was left
  const std::vector<ShadingNormals>& shading;  ///< one per body; empty when shading is off
  std::span<const Pose> X_WB_start;            ///< poses at the start of the frame [m]
};

}  // namespace tactum::inline v0_1
