#include "tactum/scene/scene_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tactum/math/screw.h"

namespace tactum::scene_file_test {
namespace {

// Two bodies, one grasped; every line of it is used by the tests of errors below.
const char* const kSound = R"(schema = 1
description = "a box over a plate"
gravity_m_per_s2 = [0, 0, -9.81]
[[body]]
name = "plate"
part = { box = { size_m = [0.2, 0.2, 0.01] } }
joint = { kind = "fixed" }
[[body]]
name = "box"
part = { box = { size_m = [0.02, 0.04, 0.06] } }
pos_m = [0, 0, 0.1]
mass_kg = 0.12
joint = { kind = "hinge", axis = [0, 0, 2], anchor_m = [0.01, 0, 0], friction_Nm = 0.1 }
[coupling]
stiffness_N_per_m = 700
[tool]
body = "box"
[hand]
grip = "firm"
[[hand.step]]
turn_deg = 30
duration_s = 1
[[goal]]
kind = "turned"
body = "box"
at_least_deg = 20
)";

Result<Scene> parsed(const std::string& text) { return parse_scene(text, "test", "test.toml", {}); }

/// The sound scene with one line (counted from 1) put in the place of another.
std::string with_line(int number, const std::string& line) {
  std::string text;
  std::string rest = kSound;
  for (int i = 1; !rest.empty(); ++i) {
    const std::size_t end = rest.find('\n');
    text += (i == number ? line : rest.substr(0, end)) + "\n";
    rest = rest.substr(end + 1);
  }
  return text;
}

std::string error_of(const std::string& text) {
  const Result<Scene> scene = parsed(text);
  return scene ? "no error" : scene.error().message();
}

void expect_error(int line, const std::string& text, const std::string& place, const std::string& said) {
  const std::string error = error_of(with_line(line, text));
  EXPECT_EQ(error.substr(0, place.size() + 2), place + ": ") << error;
  EXPECT_NE(error.find(said), std::string::npos) << error << "\n  lacks: " << said;
}

TEST(SceneFile, BuildsTheWorldItTells) {
  const Result<Scene> scene = parsed(kSound);
  ASSERT_TRUE(scene) << scene.error().message();
  EXPECT_EQ(scene->name, "test");
  EXPECT_EQ(scene->description, "a box over a plate");
  EXPECT_EQ(scene->world.gravity_W, Vec3(0, 0, -9.81));
  ASSERT_EQ(scene->world.bodies.size(), 2u);
  const Body& plate = scene->world.bodies[0];
  EXPECT_EQ(plate.joint.kind, JointKind::kFixed);
  EXPECT_NEAR(plate.mass_kg, 0.2 * 0.2 * 0.01 * 1000.0, 1e-12);
  const Body& box = scene->world.bodies[1];
  EXPECT_NEAR(box.mass_kg, 0.12, 1e-15);
  const Vec3 inertia =
      0.12 / 12.0 * Vec3(0.04 * 0.04 + 0.06 * 0.06, 0.02 * 0.02 + 0.06 * 0.06, 0.02 * 0.02 + 0.04 * 0.04);
  EXPECT_TRUE(box.inertia_B.isApprox(Mat3(inertia.asDiagonal()), 1e-12)) << box.inertia_B;
  EXPECT_TRUE(box.X_WB.p.isApprox(Vec3(0, 0, 0.1)));
  EXPECT_EQ(box.joint.kind, JointKind::kHinge);
  EXPECT_EQ(box.joint.axis_W, Vec3::UnitZ());
  EXPECT_TRUE(box.joint.anchor_W.isApprox(Vec3(0.01, 0, 0.1)));
  EXPECT_EQ(box.joint.friction, 0.1);
  EXPECT_EQ(scene->settings.coupling.stiffness_N_per_m, 700.0);
  EXPECT_EQ(scene->grip, "firm");
  EXPECT_EQ(scene->settings.tool.body, 1);
  EXPECT_EQ(scene->goals.size(), 1u);
  EXPECT_EQ(frames_of_motion(*scene), 1000);
}

TEST(SceneFile, BodyFrameIsAtTheCentreOfMassAndThePartStaysWhereToldSo) {
  // A peg's own origin is at its tip, half its length below the centre of mass; turned onto its side.
  const Result<Scene> scene = parsed(R"(schema = 1
[[body]]
name = "peg"
part = { peg = { length_m = 0.06 } }
pos_m = [0.1, 0.2, 0.3]
rpy_deg = [0, 90, 0]
)");
  ASSERT_TRUE(scene) << scene.error().message();
  const Body& peg = scene->world.bodies[0];
  EXPECT_TRUE(peg.X_WB.p.isApprox(Vec3(0.13, 0.2, 0.3), 1e-12)) << peg.X_WB.p.transpose();
  EXPECT_TRUE(part_pose(peg, peg.X_WB).p.isApprox(Vec3(0.1, 0.2, 0.3), 1e-12));
  Aabb box;  // of the pieces, in the world: they are at the place given in the file
  for (const Polytope& piece : peg.part->pieces)
    for (const Vec3& vertex : piece.vertices) box.extend(peg.X_WB * vertex);
  EXPECT_TRUE(box.min.isApprox(Vec3(0.1, 0.193, 0.29), 1e-12)) << box.min.transpose();
  EXPECT_TRUE(box.max.isApprox(Vec3(0.16, 0.207, 0.31), 1e-12)) << box.max.transpose();
}

TEST(SceneFile, OrientationsAgree) {
  const auto rotation = [](const std::string& line) {
    return parsed("schema = 1\n[[body]]\nname = \"b\"\npart = { sphere = { radius_m = 1 } }\n" + line)
        ->world.bodies[0]
        .X_WB.R;
  };
  const Mat3 roll_then_yaw = exp_rotation(Vec3(0, 0, 0.5 * kPi)) * exp_rotation(Vec3(0.5 * kPi, 0, 0));
  EXPECT_TRUE(rotation("rpy_deg = [90, 0, 90]").isApprox(roll_then_yaw, 1e-12));
  EXPECT_TRUE(rotation("quat_wxyz = [0.5, 0.5, 0.5, 0.5]").isApprox(roll_then_yaw, 1e-12));
  EXPECT_TRUE(rotation("quat_wxyz = [0.50005, 0.5, 0.5, 0.5]").isApprox(roll_then_yaw, 1e-3));
  const Mat3 nearly = rotation("quat_wxyz = [0.7071, 0.7071, 0, 0]");
  EXPECT_TRUE((nearly * nearly.transpose()).isApprox(Mat3::Identity(), 1e-15));
}

TEST(SceneFile, HandleStartsWithTheDevicesAxesAtTheGrasp) {
  for (const char* grasp :
       {"centre", "rim\"\nradius_m = 0.03\nangle_deg = 90\n#", "point\"\npos_m = [0, 0.02, 0]\n#"}) {
    const Result<Scene> scene =
        parsed(with_line(17, std::string("body = \"box\"\ngrasp = \"") + grasp + "\""));
    ASSERT_TRUE(scene) << scene.error().message();
    const Body& box = scene->world.bodies[1];
    const Pose X_WH = box.X_WB * scene->settings.tool.X_BH;
    EXPECT_TRUE(X_WH.R.isApprox(scene->settings.workspace.X_WD.R, 1e-12));
    const Vec3 expected = grasp[0] == 'c'   ? Vec3(0.01, 0, 0.1)     // on the axis, beside the centre of mass
                          : grasp[0] == 'r' ? Vec3(0.01, 0.03, 0.1)  // 90 degrees on from x
                                            : Vec3(0, 0.02, 0.1);
    EXPECT_TRUE(X_WH.p.isApprox(expected, 1e-12)) << grasp << ": " << X_WH.p.transpose();
    EXPECT_TRUE(scene->hand->at(0.0).X_DH.p.isZero(1e-12));  // the device's middle
  }
}

TEST(SceneFile, HandTurnsAboutTheHingeWhateverTheDevicesPlaceAndScale) {
  for (const char* workspace :
       {"", "scale = 2", "rpy_deg = [10, 20, 30]\nscale = 3\npos_m = [0.02, 0.01, 0.05]"}) {
    const std::string rim = "body = \"box\"\ngrasp = \"rim\"\nradius_m = 0.03\n[workspace]\n";
    const Result<Scene> scene = parsed(with_line(17, rim + workspace));
    ASSERT_TRUE(scene) << scene.error().message();
    const Body& box = scene->world.bodies[1];
    const Pose X_WH0 = box.X_WB * scene->settings.tool.X_BH;
    const Workspace& space = scene->settings.workspace;
    for (const double t : {0.0, 0.3, 1.0, 5.0}) {
      const Pose X_DH = scene->hand->at(t).X_DH;
      const Pose X_WH{space.X_WD.R * X_DH.R, space.X_WD * (space.scale * X_DH.p)};
      const double q = std::min(t, 1.0);
      const double angle = kPi / 6.0 * q * q * q * (10.0 - 15.0 * q + 6.0 * q * q);
      const Mat3 R = exp_rotation(angle * Vec3::UnitZ());
      EXPECT_TRUE(X_WH.p.isApprox(box.joint.anchor_W + R * (X_WH0.p - box.joint.anchor_W), 1e-12))
          << workspace;
      EXPECT_TRUE(X_WH.R.isApprox(R * X_WH0.R, 1e-12)) << workspace;
    }
  }
}

TEST(SceneFile, StepsFollowOneAnotherAndRepeat) {
  const Result<Scene> scene = parsed(with_line(20, R"(repeat = 2
[[hand.step]]
hold_s = 0.5
[[hand.step]]
offset_m = [0.01, 0, 0]
duration_s = 1
profile = "steady"
button = true
[[hand.step]])"));
  ASSERT_TRUE(scene) << scene.error().message();
  EXPECT_NEAR(scene->hand->duration_s(), 5.0, 1e-12);
  EXPECT_TRUE(scene->hand->at(0.4).X_DH.p.isZero(1e-12));
  EXPECT_EQ(scene->hand->at(0.4).buttons, 0u);
  EXPECT_TRUE(scene->hand->at(1.0).X_DH.p.isApprox(Vec3(0.005, 0, 0), 1e-9));
  EXPECT_EQ(scene->hand->at(1.0).buttons, 1u);
  EXPECT_TRUE(scene->hand->at(1.5).X_DH.p.isApprox(Vec3(0.01, 0, 0), 1e-9));
}

TEST(SceneErrors, SoundSceneHasNone) { EXPECT_EQ(error_of(kSound), "no error"); }

TEST(SceneErrors, NotToml) {
  expect_error(2, "description = \"no end", "test.toml:2:22", "not TOML");
  expect_error(1, "schema = 1\nschema = 1", "test.toml:2:10", "not TOML");
}

TEST(SceneErrors, Schema) {
  expect_error(1, "schema = 2", "test.toml:1:10", "schema 2 is newer than this program (1)");
  expect_error(1, "schema = 0", "test.toml:1:10", "found 0, expected 1 to 1");
  EXPECT_NE(error_of(with_line(1, "")).find("missing key \"schema\""), std::string::npos);
}

TEST(SceneErrors, UnknownKeysNameTheNearest) {
  expect_error(15, "stifness_N_per_m = 700", "test.toml:15:1", "expected \"stiffness_N_per_m\"");
  expect_error(15, "stiffness = 700", "test.toml:15:1", "expected \"stiffness_N_per_m\"");
  expect_error(2, "descripton = \"x\"", "test.toml:2:1",
               "unknown key in the file: found \"descripton\", expected \"description\"");
  expect_error(14, "[cuopling]", "test.toml:14:2", "expected \"coupling\"");
  expect_error(10, "part = { box = { size_m = [1, 1, 1], colour = 3 } }", "test.toml:10:38",
               "unknown key in [body 2.part.box]");
  expect_error(10, "part = { bx = { size_m = [1, 1, 1] } }", "test.toml:10:10", "expected \"box\"");
  expect_error(24, "kind = \"turned\"\nquickly = true", "test.toml:25:1",
               "unknown key in [goal 1]: found \"quickly\", expected one of");
}

TEST(SceneErrors, WrongTypes) {
  expect_error(15, "stiffness_N_per_m = \"hard\"", "test.toml:15:21", "found \"hard\", expected a number");
  expect_error(11, "pos_m = 3", "test.toml:11:9", "found 3, expected 3 numbers");
  expect_error(11, "pos_m = [0, 0]", "test.toml:11:9", "found an array of 2, expected 3 numbers");
  expect_error(11, "pos_m = [0, \"up\", 0]", "test.toml:11:13", "found \"up\", expected a finite number");
  expect_error(9, "name = 5", "test.toml:9:8", "found 5, expected a text");
  expect_error(7, "joint = \"fixed\"", "test.toml:7:9", "expected a table");
  expect_error(18, "[[hand]]", "test.toml:18:1", "expected a table");
  expect_error(24, "kind = 1", "test.toml:24:8", "found 1, expected a text");
  EXPECT_NE(error_of("schema = 1\nbody = 3").find("test.toml:2:8: wrong type of \"body\""),
            std::string::npos);
  EXPECT_NE(error_of("schema = 1\nbody = [3]").find("test.toml:2:9"), std::string::npos);
}

TEST(SceneErrors, OutOfRange) {
  expect_error(12, "mass_kg = -1", "test.toml:12:11", "found -1, expected more than 0");
  expect_error(12, "mass_kg = nan", "test.toml:12:11", "found nan, expected more than 0");
  expect_error(12, "density_kg_per_m3 = 0", "test.toml:12:21", "expected more than 0");
  expect_error(11, "pos_m = [0, inf, 0]", "test.toml:11:13", "found inf");
  expect_error(13, "joint = { kind = \"hinge\", axis = [0, 0, 0] }", "test.toml:13:34", "no direction");
  expect_error(10, "part = { box = { size_m = [1, -1, 1] } }", "test.toml:10:27", "three numbers above 0");
  expect_error(10, "part = { gear = { teeth = 7 } }", "test.toml:10:17", "found 7, expected 18 to 400");
  expect_error(15, "damping_Ns_per_m = -0.1", "test.toml:15:20", "expected 0 to 20");
}

TEST(SceneErrors, Orientations) {
  expect_error(11, "quat_wxyz = [1, 1, 0, 0]", "test.toml:11:13", "found length 1.41421, expected length 1");
  expect_error(11, "quat_wxyz = [0, 0, 0, 0]", "test.toml:11:13", "found length 0");
  expect_error(11, "quat_wxyz = [1, 0, 0]", "test.toml:11:13", "expected 4 numbers");
  expect_error(11, "quat_wxyz = [1, 0, 0, 0]\nrpy_deg = [0, 0, 0]", "test.toml:12:11", "two orientations");
}

TEST(SceneErrors, Missing) {
  expect_error(9, "", "test.toml:8:1", "missing key \"name\" in [body 2]");
  expect_error(10, "", "test.toml:8:1", "missing key \"part\" in [body 2]");
  expect_error(10, "part = { box = { } }", "test.toml:10:16", "missing key \"size_m\" in [body 2.part.box]");
  expect_error(10, "part = { sphere = { } }", "test.toml:10:19", "missing key \"radius_m\"");
  expect_error(13, "joint = { kind = \"hinge\" }", "test.toml:13:9", "missing key \"axis\"");
  expect_error(22, "", "test.toml:20:1", "missing key \"duration_s\"");
  expect_error(17, "grasp = \"centre\"", "test.toml:16:1", "missing key \"body\" in [tool]");
  EXPECT_NE(error_of("schema = 1").find("no [[body]]"), std::string::npos);
}

TEST(SceneErrors, Names) {
  expect_error(9, "name = \"plate\"", "test.toml:9:8", "two bodies of one name");
  expect_error(9, "name = \"\"", "test.toml:9:8", "without a name");
  expect_error(17, "body = \"bxo\"", "test.toml:17:8", "found \"bxo\", expected \"box\"");
  expect_error(25, "body = \"xylophone\"", "test.toml:25:8", "expected the name of a [[body]]");
  expect_error(19, "grip = \"frim\"", "test.toml:19:8", "frim");
  expect_error(2, "device = \"premium\"", "test.toml:2:10", "premium");
  expect_error(
      24, "kind = \"dance\"", "test.toml:24:8",
      "found \"dance\", expected one of \"turned\", \"moved\", \"touched\", \"picked\", \"followed\"");
  expect_error(13, "joint = { kind = \"screw\" }", "test.toml:13:18",
               "expected one of \"free\", \"fixed\", \"hinge\", \"slider\", \"ball\"");
}

TEST(SceneErrors, Contradictions) {
  expect_error(12, "mass_kg = 1\ndensity_kg_per_m3 = 2", "test.toml:12:11", "two masses");
  expect_error(10, "part = { box = { size_m = [1, 1, 1] }, sphere = { radius_m = 1 } }", "test.toml:10:8",
               "found box and sphere");
  expect_error(10, "part = { }", "test.toml:10:8", "must have one shape: found none");
  expect_error(10, "part = { scale = 2, box = { size_m = [1, 1, 1] } }", "test.toml:10:18",
               "found box, expected mesh");
  expect_error(13, "joint = { kind = \"free\", axis = [0, 0, 1] }", "test.toml:13:33",
               "expected hinge, slider");
  expect_error(17, "body = \"plate\"", "test.toml:17:8", "a fixed body cannot be held");
  expect_error(17, "body = \"box\"\nradius_m = 0.1", "test.toml:18:12",
               "not for this kind of grasp: found centre, expected rim");
  expect_error(21, "turn_deg = 30\nhold_s = 1", "test.toml:20:1",
               "must do one thing: found hold_s and turn_deg");
  expect_error(21, "", "test.toml:20:1", "must do one thing: found none");
  expect_error(26, "", "test.toml:23:1", "must tell one angle: found none");
  expect_error(25, "body = \"plate\"", "test.toml:25:8", "only a hinged body has an angle");
  expect_error(21, "offset_m = [1, 0, 0]", "test.toml:18:1", "leaves the workspace");
}

TEST(SceneErrors, MeshesNameEveryPlaceTried) {
  const std::string text = with_line(10, "part = { mesh = \"no/such.obj\" }");
  const Result<Scene> scene = parse_scene(text, "test", "test.toml", {"first", "second/place"});
  ASSERT_FALSE(scene);
  const std::string error = scene.error().message();
  EXPECT_EQ(error.find("test.toml:10:17: cannot find the mesh"), 0u) << error;
  EXPECT_NE(error.find("first/no/such.obj"), std::string::npos) << error;
  EXPECT_NE(error.find("second/place/no/such.obj"), std::string::npos) << error;
  EXPECT_NE(error.find("TACTUM_DATA"), std::string::npos) << error;
}

TEST(SceneErrors, FilesThatCannotBeRead) {
  EXPECT_NE(read_scene_file("no/such/scene.toml").error().message().find("no such file"), std::string::npos);
  EXPECT_FALSE(read_scene_file("."));
}

TEST(SceneErrors, NoTruncatedSceneCrashes) {
  const std::string text = kSound;
  int sound = 0;
  for (std::size_t size = 0; size < text.size(); ++size) sound += parsed(text.substr(0, size)) ? 1 : 0;
  EXPECT_LT(sound, 120);  // a scene cut after a whole line may well be sound; most cuts are not
}

}  // namespace
}  // namespace tactum::scene_file_test
