#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tactum/haptics/impulse_display.h"
#include "tactum/haptics/materials.h"
#include "tactum/scene/scene_sections.h"

namespace tactum {
namespace {

// From 10 kHz to 100 Hz.
constexpr double kShortestStep_s = 0.0001;
constexpr double kLongestStep_s = 0.01;

void read_coupling(const TomlReader& root, Coupling& coupling) {
  const TomlReader table = root.table(
      "coupling", {"stiffness_N_per_m", "stiffness_Nm_per_rad", "damping_Ns_per_m", "damping_Nms_per_rad"});
  coupling.stiffness_N_per_m = table.number("stiffness_N_per_m", coupling.stiffness_N_per_m, kPositive);
  coupling.stiffness_Nm_per_rad =
      table.number("stiffness_Nm_per_rad", coupling.stiffness_Nm_per_rad, kPositive);
  coupling.damping_Ns_per_m = table.number("damping_Ns_per_m", coupling.damping_Ns_per_m, kNotNegative);
  coupling.damping_Nms_per_rad =
      table.number("damping_Nms_per_rad", coupling.damping_Nms_per_rad, kNotNegative);
}

void read_penalty(const TomlReader& root, Penalty& penalty) {
  const TomlReader table = root.table("penalty", {"stiffness_N_per_m", "max_step_m", "min_tolerance_m"});
  penalty.stiffness_N_per_m = table.number("stiffness_N_per_m", penalty.stiffness_N_per_m, kPositive);
  penalty.max_step_m = table.number("max_step_m", penalty.max_step_m, kPositive);
  penalty.min_tolerance_m = table.number("min_tolerance_m", penalty.min_tolerance_m, kNotNegative);
}

void read_constraint(const TomlReader& root, Constraint& constraint) {
  const TomlReader table =
      root.table("constraint", {"max_step_m", "least_step_m", "max_step_on_surfaces_m", "max_turn_deg"});
  constraint.max_step_m = table.number("max_step_m", constraint.max_step_m, kPositive);
  constraint.least_step_m = table.number("least_step_m", constraint.least_step_m, kPositive);
  constraint.max_step_on_surfaces_m =
      table.number("max_step_on_surfaces_m", constraint.max_step_on_surfaces_m, kPositive);
  if (table.has("max_turn_deg"))
    constraint.max_turn_rad = radians(table.number("max_turn_deg", {}, kPositive));
}

ResponseModel response_of(const TomlReader& root) {
  return root.choice("response", "constraint", {"constraint", "penalty"}) == "penalty"
             ? ResponseModel::kPenalty
             : ResponseModel::kConstraint;
}

/// `[[friction]]` or `[[restitution]]`: a coefficient for every pair of bodies of two materials.
void read_pairs(const TomlReader& root, const char* key, Range range, const Scene& scene,
                PairCoefficients& table) {
  const auto pairs = root.tables(key, {"material_a", "material_b", "coefficient"});
  if (pairs.empty()) return;
  for (const TomlReader& pair : pairs) {
    const MaterialPair told{pair.text("material_a"), pair.text("material_b"),
                            pair.number("coefficient", {}, range)};
    const Result<void> set = set_coefficient(scene.world, told, table);
    if (!set)
      pair.fail(set.error().where.c_str(), set.error().what, set.error().found, "the material of a [[body]]");
  }
}

void read_impacts(const TomlReader& root, Scene& scene) {
  Impacts& impacts = scene.settings.impacts;
  read_pairs(root, "restitution", {0.0, 1.0}, scene, impacts.restitution);
  const TomlReader table = root.table("impacts", {"expansion_s", "amplification"});
  const double longest = static_cast<double>(ImpulseDisplay::kMostFrames) * scene.settings.dt_s;
  impacts.expansion_s = table.number("expansion_s", impacts.expansion_s, {0.0, longest});
  impacts.amplification = table.number("amplification", impacts.amplification, {0.0, 10.0});
}

void read_feel(const TomlReader& root, Shading& shading, SmoothingSettings& smoothing) {
  const TomlReader shade = root.table("shading", {"on", "crease_deg"});
  shading.on = shade.flag("on", shading.on);
  if (shade.has("crease_deg")) shading.crease_rad = radians(shade.number("crease_deg", {}, {0.0, 90.0}));
  const TomlReader smooth = root.table("smoothing", {"on", "max_force_step_N", "max_torque_step_Nm"});
  smoothing.max_force_step_N = smooth.number("max_force_step_N", smoothing.max_force_step_N, kPositive);
  smoothing.max_torque_step_Nm = smooth.number("max_torque_step_Nm", smoothing.max_torque_step_Nm, kPositive);
  if (!smooth.flag("on", true)) {
    smoothing.max_force_step_N = std::numeric_limits<double>::infinity();
    smoothing.max_torque_step_Nm = std::numeric_limits<double>::infinity();
  }
}

void read_safety(const TomlReader& root, SafetySettings& safety) {
  const TomlReader table = root.table("safety", {"max_force_N", "max_torque_Nm", "max_force_slew_N_per_s",
                                                 "max_torque_slew_Nm_per_s", "start_ramp_s", "stop_ramp_s"});
  safety.max_force_N = table.number("max_force_N", safety.max_force_N, kNotNegative);
  safety.max_torque_Nm = table.number("max_torque_Nm", safety.max_torque_Nm, kNotNegative);
  safety.max_force_slew_N_per_s =
      table.number("max_force_slew_N_per_s", safety.max_force_slew_N_per_s, kPositive);
  safety.max_torque_slew_Nm_per_s =
      table.number("max_torque_slew_Nm_per_s", safety.max_torque_slew_Nm_per_s, kPositive);
  safety.start_ramp_s = table.number("start_ramp_s", safety.start_ramp_s, kNotNegative);
  safety.stop_ramp_s = table.number("stop_ramp_s", safety.stop_ramp_s, kPositive);
}

void read_budget(const TomlReader& root, WorkBudget& budget) {
  const TomlReader table =
      root.table("budget", {"max_exact_tests", "max_contact_points", "solver_iterations", "sleep"});
  budget.max_exact_tests = table.integer("max_exact_tests", budget.max_exact_tests, 1, 1'000'000);
  budget.max_contact_points = table.integer("max_contact_points", budget.max_contact_points, 1, 100'000);
  budget.solver_iterations = table.integer("solver_iterations", budget.solver_iterations, 1, 10'000);
  budget.sleep = table.flag("sleep", budget.sleep);
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
  const TomlReader space =
      root.table("workspace", {"scale", "pos_m", "quat_wxyz", "rpy_deg", "clutch_button"});
  workspace.scale = space.number("scale", 1.0, {0.001, 1000.0});
  workspace.clutch_button = space.integer("clutch_button", -1, -1, 31);
  workspace.X_WD.R = space.rotation();

  Vec3 handle_W = Vec3::Zero();
  if (root.has("tool")) {
    const TomlReader table =
        root.table("tool", {"body", "grasp", "radius_m", "angle_deg", "pos_m", "picks", "reach_m"});
    Tool& tool = scene.settings.tool;
    tool.picks = table.flag("picks", false);
    tool.reach_m = table.number("reach_m", tool.reach_m, kPositive);
    if (tool.picks) {
      for (const char* key : {"body", "grasp", "radius_m", "angle_deg", "pos_m"})
        if (table.has(key))
          table.fail(key, fmt::format("\"{}\" does not go with \"picks\"", key), "both", "one of them");
      workspace.X_WD.p = space.vector3("pos_m", handle_W);
      return;
    }
    if (table.has("reach_m")) table.fail("reach_m", "\"reach_m\" is for picks = true only");
    const int held = body_called(table, "body", scene.world);
    if (held < 0) return;
    const Body& body = scene.world.bodies[static_cast<std::size_t>(held)];
    if (!body.moves()) {
      table.fail("body", "a fixed body cannot be held", fmt::format("\"{}\"", body.name),
                 "a free or hinged body");
      return;
    }
    tool.body = held;
    tool.X_BH.p = read_grasp(table, body);
    tool.X_BH.R = body.X_WB.R.transpose() * workspace.X_WD.R;
    handle_W = body.X_WB * tool.X_BH.p;
  }
  workspace.X_WD.p = space.vector3("pos_m", handle_W);
}

}  // namespace

void read_settings(const TomlReader& root, Scene& scene) {
  scene.settings.dt_s = root.number("dt_s", 0.001, {kShortestStep_s, kLongestStep_s});
  read_coupling(root, scene.settings.coupling);
  scene.coupling_by_device = !root.has("coupling");
  scene.settings.response = response_of(root);
  read_penalty(root, scene.settings.penalty);
  read_constraint(root, scene.settings.constraint);
  read_pairs(root, "friction", kNotNegative, scene, scene.settings.friction);
  read_impacts(root, scene);
  read_feel(root, scene.settings.shading, scene.settings.smoothing);
  read_safety(root, scene.safety);
  read_budget(root, scene.settings.budget);
  read_tool(root, scene);
}

}  // namespace tactum
