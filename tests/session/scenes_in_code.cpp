#include "session/scenes_in_code.h"

namespace tactum::testing {
namespace {

constexpr double deg(double degrees) { return degrees * (kPi / 180.0); }

Pose at(const Vec3& p, const Vec3& rpy_deg = Vec3::Zero()) { return {rotation_rpy_deg(rpy_deg), p}; }

MoveStep move(const Vec3& offset_m, double duration_s) {
  return {.offset_m = offset_m, .duration_s = duration_s};
}

MoveStep move(const Vec3& offset_m, const Vec3& rpy_deg, double duration_s) {
  return {.offset_m = offset_m, .rotation_W = rotation_rpy_deg(rpy_deg), .duration_s = duration_s};
}

HoldStep hold(double hold_s, bool button = false) { return {.hold_s = hold_s, .button = button}; }

TurnStep turn(double degrees, const Vec3& anchor_m, double duration_s, bool button = false) {
  return {.turn_rad = deg(degrees),
          .duration_s = duration_s,
          .axis = Vec3(0, 0, 1),
          .anchor_m = anchor_m,
          .button = button};
}

MovedGoal moved_by(const char* body, const Vec3& direction, double at_least_m,
                   const Vec3& point_m = Vec3::Zero()) {
  return {.body = body, .point_m = point_m, .at_least_m = at_least_m, .direction = direction};
}

MovedGoal moved_to(const char* body, const Vec3& to_m, double tolerance_m) {
  return {.body = body, .to_m = to_m, .tolerance_m = tolerance_m};
}

void set_coupling(SceneDescription& scene, const Coupling& coupling) {
  scene.settings.coupling_by_device = false;
  scene.settings.frame.coupling = coupling;
}

/// Dominoes differ in their name and place alone.
BodyDescription domino(int number, double y) {
  return {.name = "domino " + std::to_string(number),
          .part = BoxPart{{0.024, 0.008, 0.048}},
          .X_OP = at({0, y, 0.02401}),
          .density_kg_per_m3 = 1200,
          .material = "domino"};
}

BodyDescription picked_gear(const char* name, int teeth, const Pose& X_OP) {
  return {.name = name,
          .part = GearPart{{.teeth = teeth, .module_m = 0.004, .face_width_m = 0.012, .backlash_m = 0.0003}},
          .X_OP = X_OP,
          .density_kg_per_m3 = 1200,
          .joint = HingeJoint{.axis = {0, 0, 1}, .damping_Nms = 0.001, .friction_Nm = 0.005}};
}

std::vector<BodyDescription> lock_bodies() {
  const SlottedPlate slot{.slots = 1,
                          .slot_width_m = 0.0032,
                          .slot_length_m = 0.014,
                          .pitch_m = 0.02,
                          .margin_m = 0.005,
                          .thickness_m = 0.012};
  const Peg blade{.width_m = 0.003, .depth_m = 0.0138, .length_m = 0.028, .chamfer_m = 0.0008};
  return {
      {.name = "plug",
       .components = {{.name = "slot", .part = SlottedPlatePart{slot}, .X_OC = at({0, 0, -0.012})},
                      {.part = BoxPart{{0.004, 0.01, 0.004}}, .X_OC = at({0, 0.017, -0.010})}},
       .density_kg_per_m3 = 4000,
       .joint = HingeJoint{.axis = {0, 0, 1},
                           .damping_Nms = 0.0002,
                           .friction_Nm = 0.004,
                           .limits_rad = Interval{deg(1) * -5, deg(1) * 95}},
       .material = "brass"},
      {.name = "stop",
       .components = {{.part = BoxPart{{0.024, 0.016, 0.004}}, .X_OC = at({0.002, -0.003, -0.0165})},
                      {.part = BoxPart{{0.004, 0.005, 0.0125}}, .X_OC = at({0.009, -0.0085, -0.00825})}},
       .density_kg_per_m3 = 4000,
       .joint = SliderJoint{.axis = {0, 0, 1},
                            .damping_Ns_per_m = 0.5,
                            .friction_N = 0.02,
                            .stiffness_N_per_m = 60,
                            .rest_m = 0.01,
                            .limits_m = Interval{-0.016, 0}},
       .material = "brass"},
      {.name = "bolt",
       .components = {{.name = "lug",
                       .part = BoxPart{{0.008, 0.0105, 0.004}},
                       .X_OC = at({-0.0105, 0.01925, -0.010})},
                      {.part = BoxPart{{0.05, 0.006, 0.004}}, .on = "lug", .X_OC = at({-0.008, 0.00825, 0})}},
       .density_kg_per_m3 = 7000,
       .joint = SliderJoint{.axis = {1, 0, 0},
                            .damping_Ns_per_m = 1,
                            .friction_N = 0.3,
                            .limits_m = Interval{-0.02, 0.001}},
       .material = "brass"},
      {.name = "key",
       .components = {{.name = "blade", .part = PegPart{blade}},
                      {.part = PrismPart{24, 0.012, 0.004},
                       .on = "blade",
                       .X_OC = at({0, 0, 0.04}, {0, 90, 0})}},
       .X_OP = at({0, 0, 0.005}),
       .density_kg_per_m3 = 3000,
       .material = "steel"}};
}

}  // namespace

SceneDescription block_on_plate() {
  SceneDescription scene;
  scene.bodies = {{.name = "plate",
                   .part = BoxPart{{0.16, 0.16, 0.01}},
                   .X_OP = at({0, 0, -0.005}),
                   .joint = FixedJoint{}},
                  {.name = "block",
                   .part = BoxPart{{0.04, 0.03, 0.02}},
                   .X_OP = at({0, 0, 0.015}),
                   .density_kg_per_m3 = 1000}};
  scene.tool = BodyTool{.body = "block"};
  set_coupling(scene, {.stiffness_N_per_m = 600, .stiffness_Nm_per_rad = 0.3});
  scene.hand.steps = {move({0, 0, -0.009}, 1.0), move({0.03, 0.01, -0.009}, 1.5),
                      move({-0.03, -0.01, -0.009}, {0, 0, 40}, 2.0), move({0, 0, -0.005}, {0, 20, 0}, 1.5),
                      move({0, 0, 0.01}, {0, 0, 0}, 1.0)};
  scene.goals = {moved_by("block", {1, 0, 0}, 0.028), moved_by("block", {0, 0, -1}, 0.0045)};
  return scene;
}

SceneDescription peg_round_h7g6() {
  SceneDescription scene;
  scene.bodies = {{.name = "block",
                   .part = HoleBlockPart{{.sides = 64,
                                          .peg_width_m = 0.025,
                                          .clearance_m = 0.000024,
                                          .wall_m = 0.025,
                                          .hole_depth_m = 0.03,
                                          .floor_m = 0.005}},
                   .joint = FixedJoint{}},
                  {.name = "peg",
                   .part = PegPart{{.sides = 64, .width_m = 0.025, .length_m = 0.06, .chamfer_m = 0.001}},
                   .X_OP = at({0.004, 0, 0.035}),
                   .density_kg_per_m3 = 1200}};
  scene.tool = BodyTool{.body = "peg"};
  set_coupling(scene, {.stiffness_Nm_per_rad = 0.6, .damping_Nms_per_rad = 0.001});
  scene.settings.frame.constraint.least_step_m = 0.00002;
  scene.settings.frame.budget.max_contact_points = 4000;
  scene.hand.grip = "firm";
  scene.hand.tremor = TremorDescription{0.0001, deg(0.2), 15};
  scene.hand.steps = {move({0, 0, -0.006}, {1, -2, 1}, 1.0),
                      move({-0.004, 0, -0.006}, {0, 0, 0}, 1.5),
                      move({-0.004, 0, -0.038}, 2.5),
                      move({-0.002, 0.002, -0.037}, {3, 0, 0}, 0.6),
                      move({-0.006, -0.002, -0.037}, {-3, 0, 30}, 0.8),
                      move({-0.004, 0, -0.037}, {0, 3, -30}, 0.8),
                      move({-0.004, 0, -0.036}, {0, 0, 0}, 0.6),
                      move({-0.004, 0, 0.005}, 2.5),
                      hold(0.5)};
  scene.goals = {moved_by("peg", {0, 0, -1}, 0.0349), moved_to("peg", {0, 0, 0.04}, 0.002)};
  return scene;
}

SceneDescription nut_bolt() {
  SceneDescription scene;
  scene.bodies = {{.name = "bolt",
                   .part = BoltPart{{.size = "M16", .length_m = 0.03, .facets_per_turn = 32}},
                   .joint = FixedJoint{}},
                  {.name = "nut",
                   .part = NutPart{{.size = "M16", .facets_per_turn = 32}},
                   .X_OP = at({0, 0, 0.012}),
                   .density_kg_per_m3 = 8000}};
  scene.tool = BodyTool{.body = "nut", .grasp = CentreGrasp{}};
  scene.hand.grip = "firm";
  scene.hand.steps = {turn(-360, {0, 0, 0}, 5.0), turn(360, {0, 0, 0}, 5.0), hold(0.2)};
  scene.goals = {moved_by("nut", {0, 0, -1}, 0.0019), moved_to("nut", {0, 0, 0.010}, 0.0001)};
  return scene;
}

SceneDescription dipole_field() {
  SceneDescription scene;
  scene.bodies = {{.name = "magnet", .part = BoxPart{{0.03, 0.03, 0.06}}, .joint = FixedJoint{}},
                  {.name = "needle",
                   .part = BoxPart{{0.008, 0.008, 0.04}},
                   .X_OP = at({0, 0, 0.075}),
                   .mass = {.mass_kg = 0.02},
                   .field_points = {.listed = {{{0, 0, -0.02}, -2.0}, {{0, 0, 0.02}, 2.0}}}}};
  scene.fields = {{.shape = DipoleDescription{{.moment_Nm3 = 1.2e-4, .core_m = 0.03}},
                   .largest_force_N = 3,
                   .largest_torque_Nm = 0.05}};
  scene.tool = BodyTool{.body = "needle"};
  set_coupling(scene, {.stiffness_N_per_m = 600, .stiffness_Nm_per_rad = 0.3});
  scene.hand.steps = {hold(0.3),
                      move({0, 0, -0.0238}, 1.5),
                      hold(1.2),
                      move({0, 0, 0}, 1.0),
                      move({0.055, 0, 0}, 1.0),
                      move({0.055, 0, -0.05}, 1.0),
                      move({0.055, 0, -0.05}, {0, 60, 0}, 1.0),
                      hold(0.3),
                      move({0.055, 0, 0}, {0, 0, 0}, 1.0),
                      move({0, 0, 0}, 1.0)};
  scene.goals = {TouchedGoal{"magnet"}, moved_by("needle", {1, 0, 0}, 0.05)};
  return scene;
}

SceneDescription gears_pick() {
  SceneDescription scene;
  scene.bodies = {picked_gear("left", 18, {}), picked_gear("right", 20, at({0.076, 0, 0}, {0, 0, 9}))};
  scene.tool = PickingTool{};
  scene.workspace.pos_m = Vec3(-0.028, 0, 0.02);
  set_coupling(scene, {.stiffness_N_per_m = 600, .stiffness_Nm_per_rad = 0.3});
  scene.hand.tremor = TremorDescription{0.0001, deg(0.1), 2};
  const Vec3 left(0, 0, 0), right(0.076, 0, 0);
  scene.hand.steps = {move({0, 0, -0.014}, 0.6),
                      hold(0.1, true),
                      turn(60, left, 1.5, true),
                      turn(-90, left, 2.0, true),
                      hold(0.2),
                      move({0.0, 0, 0.01}, {0, 0, 0}, 0.8),
                      move({0.104, 0, 0.01}, 1.0),
                      move({0.104, 0, -0.014}, 0.6),
                      hold(0.1, true),
                      turn(100, right, 1.5, true),
                      turn(-150, right, 2.0, true),
                      hold(0.3, true),
                      hold(0.3)};
  scene.goals = {
      PickedGoal{"left"}, PickedGoal{"right"}, TurnedGoal{.body = "right", .at_least_rad = deg(-45)},
      TurnedGoal{.body = "left", .at_least_rad = deg(-85)},
      FollowedGoal{.body = "left", .driver = "right", .ratio = 1.1111111, .tolerance_rad = deg(2)}};
  return scene;
}

SceneDescription lock() {
  SceneDescription scene;
  scene.bodies = lock_bodies();
  scene.settings.friction = {{"brass", "steel", 0.1}, {"brass", "brass", 0.1}};
  scene.tool = BodyTool{.body = "key", .grasp = PointGrasp{{0, 0, 0.04}}};
  set_coupling(scene, {600, 0.6, 1.0, 0.0005});
  scene.hand.tremor = TremorDescription{0.0001, deg(0.2), 4};
  const Vec3 axis(0, 0, 0);
  scene.hand.steps = {move({0, 0, -0.018}, 1.2), turn(15, axis, 0.5),
                      turn(-15, axis, 0.5),      move({0, 0, -0.042}, {0, 0, 0}, 1.0),
                      turn(95, axis, 1.5),       hold(0.5),
                      turn(-95, axis, 1.5),      move({0, 0, 0.005}, {0, 0, 0}, 1.5)};
  scene.goals = {TurnedGoal{.body = "plug", .at_least_rad = deg(80)}, moved_by("bolt", {-1, 0, 0}, 0.008),
                 moved_by("key", {0, 0, -1}, 0.0325)};
  return scene;
}

SceneDescription dominoes() {
  SceneDescription scene;
  scene.gravity_W = {0, 0, -9.81};
  scene.bodies = {{.name = "table",
                   .part = BoxPart{{0.16, 0.36, 0.02}},
                   .X_OP = at({0, 0.03, -0.01}),
                   .joint = FixedJoint{},
                   .material = "table"},
                  {.name = "finger",
                   .part = PrismPart{16, 0.006, 0.06},
                   .X_OP = at({0, -0.17, 0.042}, {90, 0, 0}),
                   .density_kg_per_m3 = 1000,
                   .material = "domino"}};
  int number = 0;
  for (const double y : {-0.100, -0.076, -0.052, -0.028, -0.004, 0.020, 0.044, 0.068, 0.092, 0.116})
    scene.bodies.push_back(domino(++number, y));
  scene.settings.friction = {{"domino", "table", 0.5}, {"domino", "domino", 0.15}};
  scene.settings.restitution = {{"domino", "domino", 0.2}};
  scene.tool = BodyTool{.body = "finger"};
  set_coupling(scene, {600, 0.6, 1.0, 0.0005});
  scene.hand.tremor = TremorDescription{0.0001, deg(0.1), 5};
  scene.hand.steps = {move({0, 0.034, 0}, 1.0), move({0, 0.052, 0}, 1.2), move({0, 0.0, 0.01}, 1.0),
                      hold(1.5)};
  const Vec3 top(0, 0, 0.024);
  scene.goals = {TouchedGoal{"domino 1"}, moved_by("domino 5", {0, 1, 0}, 0.01, top),
                 moved_by("domino 10", {0, 0, -1}, 0.03, top)};
  return scene;
}

}  // namespace tactum::testing
