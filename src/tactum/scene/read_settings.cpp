#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "tactum/haptics/materials.h"
#include "tactum/haptics/setting_table.h"
#include "tactum/scene/scene_sections.h"

namespace tactum {
namespace {

/// The keys of a section's settings.
std::vector<const char*> keys_of(std::string_view section) {
  std::vector<const char*> keys;
  for (const SettingInfo& setting : setting_table())
    if (section == setting.section) keys.push_back(setting.key);
  return keys;
}

/// One setting, where the file has it.
void read_setting(const TomlReader& table, const SettingInfo& setting, Scene& scene) {
  if (!table.has(setting.key)) return;
  double value = setting.get(scene.settings, scene.safety);
  const int low = static_cast<int>(setting.low);
  switch (setting.kind) {
    case SettingKind::kNumber:
      value = table.number(setting.key, value, {setting.low, setting.high});
      break;
    case SettingKind::kInteger:
      value = table.integer(setting.key, static_cast<int>(value), low, static_cast<int>(setting.high));
      break;
    case SettingKind::kOnOff:
      value = table.flag(setting.key, value != 0.0) ? 1.0 : 0.0;
      break;
    case SettingKind::kChoice: {
      const std::vector<std::string> words(setting.choices.begin(), setting.choices.end());
      const std::string word = table.choice(setting.key, words[static_cast<std::size_t>(value)], words);
      value = static_cast<double>(std::find(words.begin(), words.end(), word) - words.begin());
      break;
    }
  }
  setting.set(scene.settings, scene.safety, value);
}

/// All settings of a section.
void read_section(const TomlReader& table, std::string_view section, Scene& scene) {
  for (const SettingInfo& setting : setting_table())
    if (section == setting.section) read_setting(table, setting, scene);
}

/// `[[friction]]` or `[[restitution]]`: a coefficient for every pair of bodies of two materials.
void read_pairs(const TomlReader& root, const char* key, Range range, const Scene& scene,
                PairCoefficients& table) {
  const auto pairs = root.tables(key, {"material_a", "material_b", "coefficient"});
  if (pairs.empty()) return;
  for (const TomlReader& pair : pairs) {
    const MaterialPair material_pair{pair.text("material_a"), pair.text("material_b"),
                                     pair.number("coefficient", {}, range)};
    const Result<void> set = set_coefficient(scene.world, material_pair, table);
    if (!set)
      pair.fail(set.error().where.c_str(), set.error().what, set.error().found, "the material of a [[body]]");
  }
}

/// The line of a hinge, told in the body's frame.
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

/// Where the handle sits in the held body. Centre: on the hinge's axis (or at the centre of mass of a body
/// without one). Rim: `radius_m` from the axis in the direction told by `angle_deg` about it, from the part's
/// x axis.
Vec3 read_grasp(const TomlReader& table, const Body& body) {
  const std::string grasp = table.choice("grasp", "centre", {"centre", "rim", "point"});
  for (const char* key : {"radius_m", "angle_deg"})
    if (grasp != "rim" && table.has(key))
      table.fail(key, fmt::format("\"{}\" is for grasp = \"rim\" only", key), fmt::format("\"{}\"", grasp),
                 "\"rim\"");
  if (grasp != "point" && table.has("pos_m"))
    table.fail("pos_m", "\"pos_m\" is for grasp = \"point\" only", fmt::format("\"{}\"", grasp), "\"point\"");
  const bool hinged = body.joint.kind == JointKind::kHinge;
  if (grasp == "point") return p_BP_of(body) + table.vector3("pos_m");
  if (grasp == "centre") return hinged ? middle_of(hinge_of(body)) : Vec3::Zero();
  if (!hinged) {
    table.fail("grasp", "only a hinged body has a rim to hold", fmt::format("\"{}\"", body.name),
               "a body whose joint is a hinge");
    return Vec3::Zero();
  }
  const double radius = table.number("radius_m", {}, kPositive);
  const double angle = radians(table.number("angle_deg", 0.0));
  const HingeLine hinge = hinge_of(body);
  Vec3 x = Vec3::UnitX() - hinge.axis_B * hinge.axis_B.x();
  x = x.squaredNorm() > 0.5 * 0.5 ? Vec3(x.normalized()) : any_orthogonal(hinge.axis_B);
  return middle_of(hinge) + radius * (std::cos(angle) * x + std::sin(angle) * hinge.axis_B.cross(x));
}

/// [tool] and [workspace]. Unless told otherwise the device's middle is where the handle starts, and its axes
/// are the world's; the handle starts with the device's axes, whatever the body's.
void read_tool(const TomlReader& root, Scene& scene) {
  Workspace& workspace = scene.settings.workspace;
  std::vector<const char*> keys = keys_of("workspace");
  keys.insert(keys.end(), {"pos_m", "quat_wxyz", "rpy_deg"});
  const TomlReader space = root.table("workspace", keys);
  read_section(space, "workspace", scene);
  workspace.X_WD.R = space.rotation();

  Vec3 handle_W = Vec3::Zero();
  if (root.has("tool")) {
    const TomlReader table =
        root.table("tool", {"body", "grasp", "radius_m", "angle_deg", "pos_m", "picks", "pick_distance_m"});
    Tool& tool = scene.settings.tool;
    tool.picks = table.flag("picks", false);
    tool.pick_distance_m = table.number("pick_distance_m", tool.pick_distance_m, kPositive);
    if (tool.picks) {
      for (const char* key : {"body", "grasp", "radius_m", "angle_deg", "pos_m"})
        if (table.has(key))
          table.fail(key, fmt::format("\"{}\" does not go with \"picks\"", key), "both", "one of them");
      workspace.X_WD.p = space.vector3("pos_m", handle_W);
      return;
    }
    if (table.has("pick_distance_m"))
      table.fail("pick_distance_m", "\"pick_distance_m\" is for picks = true only");
    const int grasped = body_called(table, "body", scene.world);
    if (grasped < 0) return;
    const Body& body = scene.world.bodies[static_cast<std::size_t>(grasped)];
    if (!body.moves()) {
      table.fail("body", "a fixed body cannot be held", fmt::format("\"{}\"", body.name),
                 "a free or hinged body");
      return;
    }
    tool.body = grasped;
    tool.X_BH.p = read_grasp(table, body);
    tool.X_BH.R = body.X_WB.R.transpose() * workspace.X_WD.R;
    handle_W = body.X_WB * tool.X_BH.p;
  }
  workspace.X_WD.p = space.vector3("pos_m", handle_W);
}

}  // namespace

void read_settings(const TomlReader& root, Scene& scene) {
  scene.coupling_by_device = !root.has("coupling");
  read_section(root, "", scene);
  std::string_view last;
  for (const SettingInfo& setting : setting_table()) {
    const std::string_view section = setting.section;
    if (section.empty() || section == last || section == "workspace") continue;
    read_section(root.table(setting.section, keys_of(section)), section, scene);
    last = section;
  }
  read_pairs(root, "friction", kNotNegative, scene, scene.settings.friction);
  read_pairs(root, "restitution", {0.0, 1.0}, scene, scene.settings.impacts.restitution);
  read_tool(root, scene);
}

}  // namespace tactum
