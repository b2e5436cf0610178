#include <fmt/format.h>

#include <algorithm>

#include "tactum/devices/simulated_device.h"
#include "tactum/scene/scene_sections.h"

namespace tactum {
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

/// The body the hand holds; null when it holds none.
const Body* grasped_body(const Scene& scene) {
  const int grasped = scene.settings.tool.body;
  return grasped < 0 ? nullptr : &scene.world.bodies[static_cast<std::size_t>(grasped)];
}

Pose handle_at_start(const Scene& scene) {
  const Body* grasped = grasped_body(scene);
  return grasped ? grasped->X_WB * scene.settings.tool.X_BH : scene.settings.workspace.X_WD;
}

/// `hold_s`: the hand rests.
void add_hold(const TomlReader& step, ScriptedMotion& motion) {
  for (const char* key : {"duration_s", "profile"})
    if (step.has(key))
      step.fail(key, fmt::format("\"{}\" does not go with \"hold_s\"", key), "both", "one of them");
  const double duration = step.number("hold_s", {}, kPositive);
  if (!step.errors()) motion.hold(duration, step.flag("button", false) ? 1u : 0u);
}

MotionProfile profile_of(const TomlReader& step) {
  return step.choice("profile", "minimum-jerk", {"minimum-jerk", "steady"}) == "steady"
             ? MotionProfile::kSteady
             : MotionProfile::kMinimumJerk;
}

/// `turn_deg`: about a line of the world, the held body's hinge when none is told.
void add_turn(const TomlReader& step, const Scene& scene, const DeviceMap& map, ScriptedMotion& motion) {
  const Body* grasped = grasped_body(scene);
  const bool hinged = grasped && grasped->joint.kind == JointKind::kHinge;
  std::optional<Vec3> axis;
  std::optional<Vec3> anchor;
  if (hinged) {
    axis = grasped->joint.axis_W;
    anchor = grasped->joint.anchor_W;
  }
  const Vec3 axis_W = step.unit_vector3("axis", axis);
  const Vec3 anchor_W = step.vector3("anchor_m", anchor);
  const double angle = radians(step.number("turn_deg"));
  const double duration = step.number("duration_s", {}, kPositive);
  const MotionProfile profile = profile_of(step);
  const bool button = step.flag("button", false);
  if (step.errors()) return;
  motion.turn_about(duration, map.point_to_device(anchor_W), map.direction_to_device(axis_W), angle, profile,
                    button ? 1u : 0u);
}

/// `offset_m` and/or an orientation, both from the handle's pose at the start; what is not told stays as it
/// is.
void add_move(const TomlReader& step, const Pose& X_WH_start, const DeviceMap& map, ScriptedMotion& motion) {
  Pose X_WH = map.to_world(motion.end_pose());
  if (step.has("offset_m")) X_WH.p = X_WH_start.p + step.vector3("offset_m");
  if (step.has("rpy_deg") || step.has("quat_wxyz")) X_WH.R = step.rotation() * X_WH_start.R;
  const double duration = step.number("duration_s", {}, kPositive);
  const MotionProfile profile = profile_of(step);
  const bool button = step.flag("button", false);
  if (!step.errors()) motion.move_to(duration, map.to_device(X_WH), profile, button ? 1u : 0u);
}

void add_step(const TomlReader& step, const Scene& scene, const DeviceMap& map, ScriptedMotion& motion) {
  const bool holds = step.has("hold_s");
  const bool turns = step.has("turn_deg");
  const bool moves = step.has("offset_m") || step.has("rpy_deg") || step.has("quat_wxyz");
  if (holds + turns + moves != 1) {
    step.fail(nullptr, fmt::format("{} must do one thing", step.section()),
              holds + turns + moves == 0 ? "none" : "several",
              "hold_s, turn_deg, or offset_m and an orientation");
    return;
  }
  for (const char* key : {"axis", "anchor_m"})
    if (!turns && step.has(key)) step.fail(key, fmt::format("\"{}\" goes with \"turn_deg\" only", key));
  if (holds) add_hold(step, motion);
  if (turns) add_turn(step, scene, map, motion);
  if (moves) add_move(step, handle_at_start(scene), map, motion);
}

std::shared_ptr<const HandMotion> with_tremor(const TomlReader& hand,
                                              std::shared_ptr<const HandMotion> motion) {
  if (!hand.has("tremor")) return motion;
  const TomlReader table = hand.table("tremor", {"translation_m", "rotation_deg", "seed"});
  const double translation = table.number("translation_m", 0.0, {0.0, 0.01});
  const double rotation = radians(table.number("rotation_deg", 0.0, {0.0, 20.0}));
  const int seed = table.integer("seed", 1, 0, 1'000'000'000);
  return std::make_shared<TremorMotion>(
      std::move(motion), physiological_tremor(translation, rotation, static_cast<std::uint64_t>(seed)));
}

/// The hand must not be sent where the device ends.
void check_workspace(const TomlReader& hand, const HandMotion& motion, const SimulatedDeviceModel& device) {
  constexpr double kLook_s = 0.01;
  double farthest = 0.0;
  for (double t = 0.0; t <= motion.duration_s(); t += kLook_s)
    farthest = std::max(farthest, motion.at(t).X_DH.p.norm());
  if (farthest <= device.workspace_radius_m) return;
  hand.fail(nullptr, fmt::format("the motion leaves the workspace of the {}", device.name),
            fmt::format("{:.4f} m from its middle", farthest),
            fmt::format("at most {:.4f} m; see [workspace] scale and pos_m", device.workspace_radius_m));
}

}  // namespace

void read_hand(const TomlReader& root, Scene& scene) {
  scene.device = root.text("device", "premium-1.5-6dof");
  const Result<SimulatedDeviceModel> device = simulated_device_preset(scene.device);
  if (!device) {
    root.fail("device", device.error().what, device.error().found, device.error().expected);
    return;
  }
  const TomlReader hand = root.table("hand", {"grip", "tremor", "repeat", "step"});
  scene.grip = hand.text("grip", "medium");
  const Result<HandModel> grip = hand_model(scene.grip);
  if (!grip) hand.fail("grip", grip.error().what, grip.error().found, grip.error().expected);

  const int repeat = hand.integer("repeat", 1, 1, 1000);
  const auto steps = hand.tables("step", {"hold_s", "turn_deg", "axis", "anchor_m", "offset_m", "rpy_deg",
                                          "quat_wxyz", "duration_s", "profile", "button"});
  const DeviceMap map(scene.settings.workspace);
  ScriptedMotion motion(map.to_device(handle_at_start(scene)));
  for (int round = 0; round < repeat && !hand.errors(); ++round)
    for (const TomlReader& step : steps) add_step(step, scene, map, motion);
  if (hand.errors()) return;
  scene.hand = with_tremor(hand, std::make_shared<ScriptedMotion>(std::move(motion)));
  check_workspace(hand, *scene.hand, *device);
}

}  // namespace tactum
