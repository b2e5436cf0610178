#include <fmt/format.h>

#include <cmath>

#include "tactum/haptics/setting_table.h"
#include "tactum/scene/scene_builder.h"

namespace tactum::inline v0_1 {
namespace {

void set_pairs(SceneBuilder& builder, const char* key, const std::vector<MaterialPair>& pairs,
               const World& world, PairCoefficients& table) {
  for (std::size_t i = 0; i < pairs.size(); ++i)
    if (const Result<void> set = set_coefficient(world, pairs[i], table); !set)
      builder.fail(item_path(item_path("", key, i), set.error().where), set.error().what, set.error().found,
                   "the material of a [[body]]");
}

/// The line of a hinge, in the body's frame.
struct HingeLine {
  Vec3 point_B, axis_B;
};
HingeLine hinge_of(const Body& body) {
  const Pose X_BW = body.X_WB.inverse();
  return {X_BW * body.joint.anchor_W, X_BW.R * body.joint.axis_W};
}

/// The point of the hinge's axis beside the centre of mass.
Vec3 middle_of(const HingeLine& hinge) {
  return hinge.point_B - hinge.axis_B * hinge.axis_B.dot(hinge.point_B);
}

/// A point beside the hinge's axis, in the direction of the part's x axis turned by the grasp's angle.
Vec3 rim_of(const HingeLine& hinge, const RimGrasp& grasp) {
  const double angle = grasp.angle_rad;
  Vec3 x = Vec3::UnitX() - hinge.axis_B * hinge.axis_B.x();
  x = x.squaredNorm() > 0.5 * 0.5 ? Vec3(x.normalized()) : any_orthogonal(hinge.axis_B);
  return middle_of(hinge) + grasp.radius_m * (std::cos(angle) * x + std::sin(angle) * hinge.axis_B.cross(x));
}

/// A hand as it is described, its tool at `path`.
struct DescribedHand {
  std::string path;
  const ToolDescription* tool;  ///< null: nothing is grasped
  const WorkspaceDescription& workspace;
};

/// The place of the handle in the grasped body.
Vec3 handle_in(SceneBuilder& builder, const std::string& path, const BodyTool& tool, const Body& body) {
  const bool hinged = body.joint.kind == JointKind::kHinge;
  if (const auto* point = std::get_if<PointGrasp>(&tool.grasp)) return p_BP_of(body) + point->pos_m;
  const auto* rim = std::get_if<RimGrasp>(&tool.grasp);
  if (rim == nullptr) return hinged ? middle_of(hinge_of(body)) : Vec3::Zero();
  if (hinged) return rim_of(hinge_of(body), *rim);
  builder.fail(path + ".grasp", "only a hinged body has a rim to hold", fmt::format("\"{}\"", body.name),
               "a body whose joint is a hinge");
  return Vec3::Zero();
}

/// Grasps the body; its handle starts with the device's axes, whatever the body's. The handle's place.
Vec3 grasp_body(SceneBuilder& builder, const std::string& path, const BodyTool& grasp, const Scene& scene,
                HandSettings& hand) {
  const int index = builder.find_body(path + ".body", grasp.body, scene.world);
  if (index < 0) return Vec3::Zero();
  const Body& body = scene.world.bodies[static_cast<std::size_t>(index)];
  if (!body.moves()) {
    builder.fail(path + ".body", "a fixed body cannot be held", fmt::format("\"{}\"", body.name),
                 "a free or hinged body");
    return Vec3::Zero();
  }
  hand.tool.body = index;
  hand.tool.X_BH.p = handle_in(builder, path, grasp, body);
  hand.tool.X_BH.R = body.X_WB.R.transpose() * hand.workspace.X_WD.R;
  return body.X_WB * hand.tool.X_BH.p;
}

/// Sets the grasp of a hand and the place of its device. By default the device's middle is where the handle
/// starts, and its axes are the world's.
void set_hand(SceneBuilder& builder, const DescribedHand& described, const Scene& scene, HandSettings& hand) {
  Pose& X_WD = hand.workspace.X_WD;
  X_WD.R = described.workspace.R_WD;
  Vec3 handle_W = Vec3::Zero();
  if (described.tool != nullptr) {
    if (const auto* picking = std::get_if<PickingTool>(described.tool)) {
      hand.tool.picks = true;
      hand.tool.pick_distance_m = picking->pick_distance_m;
      hand.tool.centre_fraction = picking->centre_fraction;
    } else {
      handle_W = grasp_body(builder, described.path, std::get<BodyTool>(*described.tool), scene, hand);
    }
  }
  X_WD.p = described.workspace.pos_m.value_or(handle_W);
}

/// Puts what a hand has of its own over the settings of all hands.
void set_own(const std::vector<OwnSetting>& own, FrameSettings& scratch, HandSettings& hand) {
  SafetySettings elsewhere;  // build_hand() keeps those of the hand
  static_cast<HandSettings&>(scratch) = hand;
  for (const OwnSetting& each : own)
    setting_table()[static_cast<std::size_t>(setting_called(each.setting))].set(scratch, elsewhere,
                                                                                each.value);
  hand = scratch;
}

}  // namespace

void build_settings(SceneBuilder& builder, Scene& scene) {
  const SceneDescription& description = builder.description();
  const SettingsDescription& settings = description.settings;
  scene.settings = settings.frame;
  scene.safety = settings.safety;
  scene.coupling_by_device = settings.coupling_by_device;
  scene.before_changes = settings.before_changes;
  set_pairs(builder, "friction", settings.friction, scene.world, scene.settings.friction);
  set_pairs(builder, "restitution", settings.restitution, scene.world, scene.settings.impacts.restitution);

  const std::vector<OtherHandDescription>& others = description.other_hands;
  const HandSettings usual = scene.settings;
  FrameSettings scratch;
  set_hand(builder,
           {others.empty() ? "tool" : "tool[0]", description.tool ? &*description.tool : nullptr,
            description.workspace},
           scene, scene.settings);
  for (std::size_t i = 0; i < others.size(); ++i) {
    HandSettings& hand = scene.settings.other_hands.emplace_back(usual);
    set_own(others[i].hand.own, scratch, hand);
    set_hand(builder, {item_path("", "tool", i + 1), &others[i].tool, others[i].workspace}, scene, hand);
  }
}

}  // namespace tactum::inline v0_1
