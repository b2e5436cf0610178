#include "tactum/haptics/hand_stage.h"

#include "tactum/dynamics/joint.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// Moves the mapping of the device so that the probe is at the tool's grasp point, and takes the part in its
/// present orientation.
void take_first(const World& world, const Tool& tool, std::span<const Pose> X_WB, HandStage& hand) {
  if (hand.grasp.body < 0) return;
  const auto body = Index(hand.grasp.body);
  const Vec3 handle_W = X_WB[body] * tool.X_BH.p;
  hand.X_WD.p += handle_W - hand.X_WH.p;
  hand.X_WH.p = handle_W;
  take(world.bodies[body], X_WB[body], tool.centre_fraction, hand.X_WH, hand.grasp);
  if (hand.grasp.hold != Hold::kCentre) hand.grasp.X_BH.p = tool.X_BH.p;  // without rounding
}

/// Lets a hand that has released a part which another one holds leave it slowly, and ends that.
void leave_slowly(bool shared, int was_grasped, double dt_s, Grasp& grasp) {
  const bool released = was_grasped >= 0 && grasp.body < 0;
  if (released && shared) grasp.body = was_grasped;
  if (!(released && shared) && !(grasp.left < 1.0)) return;
  grasp.left -= dt_s / kHandOver_s;
  if (shared && grasp.left > 0.0) return;
  grasp.body = -1;
  grasp.left = 1.0;
}

}  // namespace

HandStage begin_hand(const HandSettings& settings) {
  HandStage hand;
  hand.X_WD = settings.workspace.X_WD;
  hand.grasp.body = settings.tool.body;
  hand.grasp.X_BH = settings.tool.X_BH;
  return hand;
}

GraspedPart track_hand(const World& world, const HandSettings& settings, double dt_s,
                       const DeviceSample& sample, std::span<const Pose> X_WB, HandStage& hand,
                       std::span<const HandInput> earlier, bool shared) noexcept {
  const bool was_known = hand.known;
  follow_hand(settings.workspace, sample, dt_s, hand);
  if (!was_known && hand.known) take_first(world, settings.tool, X_WB, hand);
  const int was_grasped = hand.grasp.body;
  if (sample.valid && hand.known)
    pick_or_release(world, X_WB, settings.tool, hand.X_WH, sample.buttons, hand.grasp);
  leave_slowly(shared, was_grasped, dt_s, hand.grasp);
  if (hand.grasp.body != was_grasped) hand.turned_W = {};
  GraspedPart grasped{.hand_known = hand.known,
                      .body = hand.grasp.body,
                      .X_BH = hand.grasp.X_BH,
                      .hold = hand.grasp.hold,
                      .axis_W = Vec3::Zero(),
                      .arm_W = Vec3::Zero(),
                      .beside_W = hand.grasp.beside_W,
                      .X_WH = hand.X_WH,
                      .V_WH = hand.V_WH,
                      .turned_W = hand.turned_W,
                      .in_field = false,
                      .field = {}};
  if (grasped.hand_known && grasped.body >= 0) {
    follow(hand.X_WH.R * (X_WB[Index(grasped.body)].R * grasped.X_BH.R).transpose(), hand.turned_W);
    grasped.turned_W = hand.turned_W;
    if (grasped.hold == Hold::kRod) {
      const Joint& hinge = world.bodies[Index(grasped.body)].joint;
      grasped.axis_W = hinge.axis_W;
      grasped.arm_W = beside_axis(hinge, X_WB[Index(grasped.body)] * grasped.X_BH.p);
    }
  }
  if (!grasped.hand_known) return grasped;
  if (grasped.body >= 0 && is_grasped(earlier, Index(grasped.body)))
    hand.field.body = -1;  // its load is another hand's
  else
    find_field_load(world, X_WB, grasped, hand.field);
  return grasped;
}

}  // namespace tactum::inline v0_1
