/// Descriptions made in code: their errors name items by path, and the same rules hold as for files.

#include "tactum/scene/scene_description.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "tactum/scene/build_scene.h"
#include "tactum/scene/scene_file.h"

namespace tactum::description_test {
namespace {

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

/// A plate, a wheel on a hinge above it and a slider, one of each section.
SceneDescription sound() {
  SceneDescription scene;
  scene.bodies = {
      {.name = "plate", .part = BoxPart{{0.2, 0.2, 0.01}}, .joint = FixedJoint{}, .material = "steel"},
      {.name = "wheel",
       .part = PrismPart{12, 0.03, 0.01},
       .X_OP = {Mat3::Identity(), {0, 0, 0.1}},
       .joint = HingeJoint{.axis = {0, 0, 2}, .limits_rad = Interval{-1.0, 2.0}},
       .material = "steel"},
      {.name = "cart",
       .components = {{.name = "bed", .part = BoxPart{{0.02, 0.02, 0.02}}},
                      {.part = BoxPart{{0.01, 0.01, 0.01}},
                       .on = "bed",
                       .X_OC = {Mat3::Identity(), {0, 0, 0.015}}}},
       .on = "plate",
       .X_OP = {Mat3::Identity(), {0.08, 0, 0.3}},
       .joint = SliderJoint{.axis = {1, 0, 0}}}};
  scene.fields = {{.shape = WellDescription{{.depth_J = 0.01, .width_m = 0.02}}}};
  scene.settings.friction = {{"steel", "steel", 0.2}};
  scene.tool = BodyTool{.body = "wheel", .grasp = RimGrasp{.radius_m = 0.02}};
  scene.hand.steps = {TurnStep{.turn_rad = 0.5, .duration_s = 1.0}};
  scene.goals = {TurnedGoal{.body = "wheel", .at_least_rad = 0.3}};
  return scene;
}

std::string error_of(const std::function<void(SceneDescription&)>& change) {
  SceneDescription scene = sound();
  change(scene);
  const Result<Scene> built = build_scene(scene);
  return built ? "no error" : built.error().message();
}

/// The error begins with the item's path and contains this.
void expect_error(const std::function<void(SceneDescription&)>& change, const std::string& path,
                  const std::string& said) {
  const std::string error = error_of(change);
  EXPECT_EQ(error.substr(0, path.size() + 2), path + ": ") << error;
  EXPECT_NE(error.find(said), std::string::npos) << error << "\n  lacks: " << said;
}

TEST(Description, BuildsWhatItSays) {
  const Result<Scene> scene = build_scene(sound());
  ASSERT_TRUE(scene) << scene.error().message();
  const World& world = scene->world;
  ASSERT_EQ(world.bodies.size(), 3u);
  EXPECT_EQ(world.bodies[1].joint.axis_W, Vec3::UnitZ());
  EXPECT_EQ(world.bodies[1].joint.lower, -1.0);
  EXPECT_EQ(world.bodies[2].part->pieces.size(), 2u);
  EXPECT_EQ(scene->settings.friction.between(0, 1), 0.2);
  EXPECT_EQ(scene->settings.tool.body, 1);
  EXPECT_TRUE(scene->coupling_by_device);
  EXPECT_EQ(frames_of_motion(*scene), 1000);
  EXPECT_EQ(scene->goals.size(), 1u);
}

TEST(DescriptionErrors, NameBodiesAndTheirPartsByPath) {
  expect_error([](auto& s) { s.bodies[1].name = "plate"; }, "body[1].name", "two bodies of one name");
  expect_error([](auto& s) { s.bodies[1].name.clear(); }, "body[1].name", "a body without a name in body[1]");
  expect_error([](auto& s) { s.bodies[1].part.reset(); }, "body[1]", "missing key \"part\" in body[1]");
  expect_error([](auto& s) { s.bodies[1].part = BoxPart{}; }, "body[1].part.box.size_m",
               "three numbers above 0");
  expect_error([](auto& s) { s.bodies[1].part = GearPart{{.teeth = 500}}; }, "body[1].part.gear.teeth",
               "found 500, expected 1 to 400");
  expect_error([](auto& s) { s.bodies[1].part = GearPart{{.teeth = 7}}; }, "body[1].part.gear",
               "found 7, expected 18 to 400");
  expect_error([](auto& s) { s.bodies[1].part = PegPart{.fit = {"H7/q6"}}; }, "body[1].part.peg.fit",
               "a shaft of");
  expect_error(
      [](auto& s) {
        s.bodies[1].part = PegPart{.fit = {"", FitPosition::kMid}};
      },
      "body[1].part.peg.fit_position", "a place within no fit");
  expect_error([](auto& s) { s.bodies[1].part = MeshPart{"no/such.obj"}; }, "body[1].part.mesh",
               "cannot find the mesh");
  expect_error([](auto& s) { s.bodies[2].components[1].on = "bde"; }, "body[2].component[1].on",
               "expected \"bed\"");
  expect_error([](auto& s) { s.bodies[2].on = "palte"; }, "body[2].on", "expected \"plate\"");
  expect_error([](auto& s) { s.bodies[2].part = BoxPart{{1, 1, 1}}; }, "body[2].part", "two ways to make");
  expect_error([](auto& s) { s.bodies[2].mass.mass_kg = s.bodies[2].density_kg_per_m3 = 1.0; },
               "body[2].mass_kg", "two masses in body[2]");
  expect_error([](auto& s) { s.bodies[2].mass.mass_kg = kNoNumber; }, "body[2].mass_kg", "more than 0");
  expect_error([](auto& s) { s.bodies[2].X_OP.p.x() = kNoNumber; }, "body[2].pos_m", "finite numbers");
  expect_error([](auto& s) { s.bodies[2].X_OP.R *= 2.0; }, "body[2].quat_wxyz", "determinant 8");
  expect_error(
      [](auto& s) {
        s.bodies[0].V_WB.v = {1, 0, 0};
      },
      "body[0].velocity_m_per_s", "a fixed body has a velocity");
}

TEST(DescriptionErrors, NameLoadsByPath) {
  expect_error([](auto& s) { s.bodies[1].load.constant.f.y() = kNoNumber; }, "body[1].force_N",
               "finite numbers");
  expect_error([](auto& s) { s.bodies[1].load.constant.t.y() = kNoNumber; }, "body[1].torque_Nm",
               "finite numbers");
  expect_error([](auto& s) { s.bodies[1].load.damping_Ns_per_m = -2.0; }, "body[1].damping_Ns_per_m",
               "found -2, expected at least 0");
  expect_error([](auto& s) { s.bodies[1].load.damping_Nms_per_rad = kNoNumber; },
               "body[1].angular_damping_Nms_per_rad", "expected at least 0");
  const char* const fixed = "a fixed body has a load: found \"plate\", expected a body that moves";
  expect_error([](auto& s) { s.bodies[0].load.constant.f.x() = 1.0; }, "body[0].force_N", fixed);
  expect_error([](auto& s) { s.bodies[0].load.constant.t.x() = 1.0; }, "body[0].torque_Nm", fixed);
  expect_error([](auto& s) { s.bodies[0].load.damping_Ns_per_m = 1.0; }, "body[0].damping_Ns_per_m", fixed);
  expect_error([](auto& s) { s.bodies[0].load.damping_Nms_per_rad = 1.0; },
               "body[0].angular_damping_Nms_per_rad", fixed);
  expect_error([](auto& s) { s.tool = PickingTool{.centre_fraction = 1.5}; }, "tool.centre_fraction",
               "found 1.5, expected 0 to 1");
}

TEST(Description, LoadsOfAFileComeIntoTheWorld) {
  const std::string text = R"(schema = 1
[[body]]
name = "vane"
part = { box = { size_m = [0.02, 0.03, 0.01] } }
force_N = [0.1, -0.2, 0.3]
torque_Nm = [0.01, 0, -0.02]
damping_Ns_per_m = 0.5
angular_damping_Nms_per_rad = 0.002
joint = { kind = "slider", axis = [1, 0, 0], damping_Ns_per_m = 4 }
[tool]
picks = true
centre_fraction = 0.4
)";
  const Result<SceneDescription> scene = parse_description(text, "vane", "vane.toml", {});
  ASSERT_TRUE(scene) << scene.error().message();
  const Result<Scene> built = build_scene(*scene);
  ASSERT_TRUE(built) << built.error().message();
  const Body& body = built->world.bodies[0];
  EXPECT_EQ(body.load.constant.f, Vec3(0.1, -0.2, 0.3));
  EXPECT_EQ(body.load.constant.t, Vec3(0.01, 0, -0.02));
  EXPECT_EQ(body.load.damping_Ns_per_m, 0.5);
  EXPECT_EQ(body.load.damping_Nms_per_rad, 0.002);
  EXPECT_EQ(body.joint.damping, 4.0);
  EXPECT_EQ(built->settings.tool.centre_fraction, 0.4);
}

TEST(DescriptionErrors, NameJointsAndFieldsByPath) {
  expect_error([](auto& s) { s.bodies[2].joint = SliderJoint{}; }, "body[2].joint.axis", "no direction");
  expect_error(
      [](auto& s) {
        s.bodies[1].joint = HingeJoint{.axis = {0, 0, 1}, .friction_Nm = -1};
      },
      "body[1].joint.friction_Nm", "found -1, expected at least 0");
  expect_error(
      [](auto& s) {
        s.bodies[1].joint = HingeJoint{.axis = {0, 0, 1}, .limits_rad = Interval{kPi / 180, 1}};
      },
      "body[1].joint.limits_deg", "do not hold the joint as it stands, at 0: found 1 to 57.29");
  expect_error([](auto& s) { s.bodies[1].joint = BallJoint{.swing_rad = 4.0}; }, "body[1].joint.swing_deg",
               "expected 0 to 180");
  EXPECT_EQ(error_of([](auto& s) { s.bodies[2].joint = BallJoint{.swing_rad = 180.0 * (kPi / 180.0)}; }),
            "no error");
  expect_error([](auto& s) { s.fields[0].shape = DipoleDescription{}; }, "field[0].core_m", "more than 0");
  expect_error([](auto& s) { s.fields[0].edge_m = 0.01; }, "field[0].edge_m", "only a grid has an edge");
  expect_error(
      [](auto& s) {
        s.fields[0].shape = WellDescription{.formula = {0.01, 0.02}, .sampled = SampledGrid{8, {1, 1, 0}}};
      },
      "field[0].sampled.size_m", "");
}

TEST(DescriptionErrors, NameSettingsHandAndGoalsByPath) {
  const auto coupled = [](SceneDescription& s, double stiffness) {
    s.settings.coupling_by_device = false;
    s.settings.frame.coupling.stiffness_N_per_m = stiffness;
  };
  EXPECT_EQ(error_of([&](auto& s) { coupled(s, 50'000); }), "no error");
  expect_error([&](auto& s) { coupled(s, 50'001); }, "coupling.stiffness_N_per_m", "expected 1 to 50000");
  expect_error([](auto& s) { s.settings.frame.coupling.damping_Ns_per_m = 2; }, "coupling",
               "the coupling is set, and chosen by the device");
  expect_error([](auto& s) { s.settings.frame.dt_s = 1.0; }, "dt_s", "expected 0.0001 to 0.01");
  expect_error([](auto& s) { s.settings.safety.max_force_N = kNoNumber; }, "safety.max_force_N", "nan");
  expect_error([](auto& s) { s.settings.frame.tool.body = 1; }, "tool", "SceneDescription::tool");
  expect_error([](auto& s) { s.settings.friction[0].material_b = "stele"; }, "friction[0].material_b",
               "no body is of this material");
  expect_error(
      [](auto& s) {
        s.settings.restitution = {{"steel", "steel", 1.5}};
      },
      "restitution[0].coefficient", "expected 0 to 1");
  expect_error([](auto& s) { s.tool = BodyTool{.body = "plate"}; }, "tool.body", "a fixed body");
  expect_error([](auto& s) { s.tool = BodyTool{.body = "cart", .grasp = RimGrasp{0.01}}; }, "tool.grasp",
               "only a hinged body has a rim");
  expect_error([](auto& s) { s.hand.device = "premium"; }, "device", "premium");
  expect_error([](auto& s) { s.hand.grip = "frim"; }, "hand.grip", "frim");
  expect_error([](auto& s) { s.hand.steps.push_back(MoveStep{.duration_s = 1}); }, "hand.step[1]",
               "goes nowhere");
  expect_error([](auto& s) { s.tool.reset(); }, "hand.step[0]", "missing key \"axis\" in hand.step[0]");
  expect_error([](auto& s) { s.hand.steps = {MoveStep{.offset_m = Vec3(1, 0, 0), .duration_s = 1}}; }, "hand",
               "leaves the workspace");
  expect_error([](auto& s) { s.goals[0] = TurnedGoal{.body = "cart", .at_least_rad = 1}; }, "goal[0].body",
               "only a hinged body has an angle");
  expect_error([](auto& s) { s.goals[0] = TurnedGoal{.body = "wheel"}; }, "goal[0]", "must tell one angle");
  expect_error([](auto& s) { s.goals[0] = MovedGoal{.body = "cart", .at_least_m = 1}; }, "goal[0]",
               "missing key \"direction\"");
}

/// The same scene as a file; an item that is changed after reading is named by the place it had there.
TEST(DescriptionErrors, OfAFileNameLineAndColumn) {
  const std::string text = R"(schema = 1
[[body]]
name = "top"
part = { prism = { sides = 8, radius_m = 0.02, height_m = 0.01 } }
velocity_m_per_s = [0.1, 0, 0]
angular_velocity_rad_per_s = [0, 0, 3]
joint = { kind = "hinge", axis = [0, 0, 1] }
)";
  Result<SceneDescription> scene = parse_description(text, "top", "top.toml", {});
  ASSERT_TRUE(scene) << scene.error().message();
  EXPECT_EQ(scene->bodies[0].V_WB.v, Vec3(0.1, 0, 0));
  EXPECT_EQ(scene->bodies[0].V_WB.w, Vec3(0, 0, 3));
  EXPECT_EQ(build_scene(*scene)->world.bodies[0].V_WB.w, Vec3(0, 0, 3));
  std::get<HingeJoint>(scene->bodies[0].joint).axis.setZero();
  EXPECT_EQ(build_scene(*scene).error().message(),
            "top.toml:7:34: \"axis\" in [body 1.joint] has no direction: found a vector of length 0, "
            "expected an axis");
  scene->bodies[0].joint = FixedJoint{};
  EXPECT_EQ(build_scene(*scene).error().where, "top.toml:5:20");
  scene->bodies[0].joint = BallJoint{.swing_rad = -1.0};  // the file has no such key: the joint's place
  EXPECT_EQ(build_scene(*scene).error().where, "top.toml:7:9");
}

/// A key of another alternative is refused in a file; in code it does not exist.
TEST(DescriptionErrors, KeysOfAnotherKind) {
  const auto error = [](const std::string& more) {
    const Result<SceneDescription> scene = parse_description(
        "schema = 1\n[[body]]\nname = \"b\"\npart = { box = { size_m = [1, 1, 1] } }\n" + more, "b", "b.toml",
        {});
    return scene ? "no error" : scene.error().message();
  };
  EXPECT_EQ(
      error("[[goal]]\nkind = \"touched\"\nbody = \"b\"\nratio = 1\n"),
      "b.toml:8:9: \"ratio\" in [goal 1] is not for this kind of goal: found touched, expected followed");
  EXPECT_EQ(error("[tool]\nbody = \"b\"\npick_distance_m = 1\n"),
            "b.toml:7:19: \"pick_distance_m\" in [tool] is not for this kind of tool: found picks = false, "
            "expected "
            "picks = true");
  EXPECT_EQ(error("[[hand.step]]\nhold_s = 1\nprofile = \"steady\"\n"),
            "b.toml:7:11: \"profile\" in [hand.step 1] is not for this kind of step: found hold_s, expected "
            "turn_deg, offset_m and an orientation");
}

}  // namespace
}  // namespace tactum::description_test
