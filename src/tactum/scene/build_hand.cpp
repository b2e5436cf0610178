#include <fmt/format.h>

#include <algorithm>

#include "tactum/devices/simulated_device.h"
#include "tactum/haptics/setting_table.h"
#include "tactum/scene/scene_builder.h"

namespace tactum::inline v0_1 {
namespace {

/// World and device frame, and back: X_WH.p = X_WD (scale p_DH).
class DeviceMap {
 public:
  explicit DeviceMap(const Workspace& workspace) : X_WD_(workspace.X_WD), scale_(workspace.scale) {}

  Vec3 point_to_device(const Vec3& p_W) const { return X_WD_.R.transpose() * (p_W - X_WD_.p) / scale_; }
  Vec3 direction_to_device(const Vec3& axis_W) const { return X_WD_.R.transpose() * axis_W; }
  Pose to_device(const Pose& X_WH) const { return {X_WD_.R.transpose() * X_WH.R, point_to_device(X_WH.p)}; }
  Pose to_world(const Pose& X_DH) const { return {X_WD_.R * X_DH.R, X_WD_ * (scale_ * X_DH.p)}; }

 private:
  Pose X_WD_;
  double scale_;
};

/// The body that is grasped at the start; null when none is.
const Body* grasped_body(const Scene& scene, const HandSettings& hand) {
  const int body = hand.tool.body;
  return body < 0 ? nullptr : &scene.world.bodies[static_cast<std::size_t>(body)];
}

Pose handle_at_start(const Scene& scene, const HandSettings& hand) {
  const Body* body = grasped_body(scene, hand);
  return body ? body->X_WB * hand.tool.X_BH : hand.workspace.X_WD;
}

/// Appends steps to a motion.
class StepPlayer {
 public:
  StepPlayer(SceneBuilder& builder, const Scene& scene, const HandSettings& hand, ScriptedMotion& motion)
      : builder_(builder), scene_(scene), hand_(hand), map_(hand.workspace), motion_(motion) {}

  void play(const HandStep& step, const std::string& path) {
    std::visit([&](const auto& kind) { append(kind, path); }, step);
  }

 private:
  void append(const HoldStep& step, const std::string&) { motion_.hold(step.hold_s, step.button ? 1u : 0u); }

  /// About a line of the world; where it is absent, the grasped body's hinge.
  void append(const TurnStep& step, const std::string& path) {
    std::optional<Vec3> axis = step.axis, anchor = step.anchor_m;
    if (const Body* body = grasped_body(scene_, hand_); body && body->joint.kind == JointKind::kHinge) {
      if (!axis) axis = body->joint.axis_W;
      if (!anchor) anchor = body->joint.anchor_W;
    }
    if (!axis || !anchor)
      return builder_.fail(
          path, fmt::format("missing key \"{}\" in {}", axis ? "anchor_m" : "axis", builder_.section(path)),
          "none", "3 numbers, or a tool whose joint is a hinge");
    motion_.turn_about(step.duration_s, map_.point_to_device(*anchor),
                       map_.direction_to_device(*axis / axis->norm()), step.turn_rad, step.profile,
                       step.button ? 1u : 0u);
  }

  void append(const MoveStep& step, const std::string&) {
    const Pose X_WH_start = handle_at_start(scene_, hand_);
    Pose X_WH = map_.to_world(motion_.end_pose());
    if (step.offset_m) X_WH.p = X_WH_start.p + *step.offset_m;
    if (step.rotation_W) X_WH.R = *step.rotation_W * X_WH_start.R;
    motion_.move_to(step.duration_s, map_.to_device(X_WH), step.profile, step.button ? 1u : 0u);
  }

  SceneBuilder& builder_;
  const Scene& scene_;
  const HandSettings& hand_;
  DeviceMap map_;
  ScriptedMotion& motion_;
};

/// Checks that the hand is not sent out of the device's workspace.
void check_workspace(SceneBuilder& builder, const std::string& path, const HandMotion& motion,
                     const SimulatedDeviceModel& device) {
  constexpr double kLook_s = 0.01;
  double farthest = 0.0;
  for (double t = 0.0; t <= motion.duration_s(); t += kLook_s)
    farthest = std::max(farthest, motion.at(t).X_DH.p.norm());
  if (farthest <= device.workspace_radius_m) return;
  builder.fail(path, fmt::format("the motion leaves the workspace of the {}", device.name),
               fmt::format("{:.4f} m from its middle", farthest),
               fmt::format("at most {:.4f} m; see [workspace] scale and pos_m", device.workspace_radius_m));
}

/// Makes the motion of a hand that is described at `path`, and whose device at `device_path`.
SceneHand made_hand(SceneBuilder& builder, const HandDescription& hand, const std::string& path,
                    const std::string& device_path, const Scene& scene, const HandSettings& settings) {
  SceneHand made;
  const Result<SimulatedDeviceModel> device = simulated_device_preset(hand.device);
  if (!device) {
    builder.fail(device_path, device.error());
    return made;
  }
  made.device = device->name;
  made.grip = hand.grip;
  if (const Result<HandModel> grip = hand_model(made.grip); !grip) builder.fail(path + ".grip", grip.error());

  ScriptedMotion motion(DeviceMap(settings.workspace).to_device(handle_at_start(scene, settings)));
  StepPlayer player(builder, scene, settings, motion);
  for (int round = 0; round < hand.repeat && !builder.errors(); ++round)
    for (std::size_t i = 0; i < hand.steps.size(); ++i)
      player.play(hand.steps[i], item_path(path, "step", i));
  if (builder.errors()) return made;
  made.hand = std::make_shared<ScriptedMotion>(std::move(motion));
  if (const auto& tremor = hand.tremor)
    made.hand = std::make_shared<TremorMotion>(
        made.hand, physiological_tremor(tremor->translation_m, tremor->rotation_rad,
                                        static_cast<std::uint64_t>(tremor->seed)));
  check_workspace(builder, path, *made.hand, *device);
  return made;
}

/// What of a hand's own settings is no part of the frame's.
void keep_own(const std::vector<OwnSetting>& own, SceneHand& hand) {
  FrameSettings elsewhere;
  for (const OwnSetting& each : own) {
    setting_table()[static_cast<std::size_t>(setting_called(each.setting))].set(elsewhere, hand.own_safety,
                                                                                each.value);
    hand.has_own_coupling = hand.has_own_coupling || each.setting.starts_with("coupling.");
  }
}

}  // namespace

void build_hand(SceneBuilder& builder, Scene& scene) {
  const SceneDescription& description = builder.description();
  static_cast<SceneHand&>(scene) =
      made_hand(builder, description.hand, "hand", "device", scene, scene.settings);
  keep_own(description.hand.own, scene);
  for (std::size_t i = 0; i < description.other_hands.size() && !builder.errors(); ++i) {
    const std::string path = item_path("", "tool", i + 1);
    scene.other_hands.push_back(made_hand(builder, description.other_hands[i].hand, path + ".hand",
                                          path + ".device", scene, scene.settings.other_hands[i]));
    keep_own(description.other_hands[i].hand.own, scene.other_hands.back());
  }
}

}  // namespace tactum::inline v0_1
