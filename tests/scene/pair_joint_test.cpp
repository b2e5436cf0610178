/// Joints between bodies in scene files: what they make, and what is refused.

#include <gtest/gtest.h>

#include "tactum/haptics/simulation.h"
#include "tactum/scene/scene_file.h"

namespace tactum::pair_joint_test {
namespace {

std::string body(const std::string& name, const std::string& joint, double x_m = 0.0) {
  return "[[body]]\nname = \"" + name + "\"\npart = { box = { size_m = [0.1, 0.02, 0.02] } }\npos_m = [" +
         std::to_string(x_m) + ", 0, 0]\n" + (joint.empty() ? "" : "joint = " + joint + "\n");
}

Result<Scene> scene_of(const std::string& bodies) {
  return parse_scene("schema = 1\n" + bodies, "joints", "joints.toml", {});
}

void expect_refused(const std::string& bodies, const std::string& place, const std::string& what) {
  const Result<Scene> scene = scene_of(bodies);
  ASSERT_FALSE(scene) << what;
  const std::string message = scene.error().message();
  EXPECT_NE(message.find(place + ": " + what), std::string::npos) << message;
}

const std::string kOnArm =
    R"({ kind = "hinge", parent = "arm", axis = [0, 0, 2], anchor_m = [-0.05, 0, 0] })";

/// The parent may stand before its body or behind it.
TEST(PairJointInFile, JoinsABodyToItsParent) {
  for (const bool reversed : {false, true}) {
    const std::string arm = body("arm", "");
    const std::string finger = body("finger", kOnArm, 0.1);
    const Result<Scene> scene = scene_of(reversed ? finger + arm : arm + finger);
    ASSERT_TRUE(scene) << scene.error().message();
    const World& world = scene->world;
    ASSERT_EQ(world.pair_joints.size(), 1u);
    const PairJoint& pair = world.pair_joints[0];
    EXPECT_EQ(world.bodies[static_cast<std::size_t>(pair.body)].name, "finger");
    EXPECT_EQ(world.bodies[static_cast<std::size_t>(pair.parent)].name, "arm");
    EXPECT_LT((pair.joint.anchor_W - Vec3(0.05, 0, 0)).norm(), 1e-15);
    EXPECT_EQ(pair.joint.axis_W, Vec3::UnitZ());
    EXPECT_EQ(world.bodies[static_cast<std::size_t>(pair.body)].no_contact_with, pair.parent);
  }
}

/// A joint to a body that does not move is one to the world; what rides on it does not move either.
TEST(PairJointInFile, AFixedParentIsTheWorld) {
  const Result<Scene> scene =
      scene_of(body("finger", kOnArm, 0.1) + body("arm", R"({ kind = "fixed", parent = "base" })") +
               body("base", R"({ kind = "fixed" })"));
  ASSERT_TRUE(scene) << scene.error().message();
  EXPECT_TRUE(scene->world.pair_joints.empty());
  EXPECT_EQ(scene->world.bodies[0].joint.kind, JointKind::kHinge);
  EXPECT_FALSE(scene->world.bodies[1].moves());
}

TEST(PairJointInFile, ContactIsAChoice) {
  const std::string joint = R"({ kind = "ball", parent = "arm", contact = true })";
  const Result<Scene> scene = scene_of(body("arm", "") + body("finger", joint, 0.2));
  ASSERT_TRUE(scene) << scene.error().message();
  EXPECT_EQ(scene->world.bodies[1].no_contact_with, -1);
}

TEST(PairJointInFile, NonsenseIsRefusedAtItsPlace) {
  expect_refused(body("finger", kOnArm), "joints.toml:6:36", "no body of this name");
  expect_refused(body("arm", kOnArm), "joints.toml:6:36", "the body is joined to itself");
  expect_refused(
      body("a", R"({ kind = "ball", parent = "b" })") + body("b", R"({ kind = "ball", parent = "a" })"),
      "joints.toml:11:35", "the joints form a circle");
  expect_refused(body("a", R"({ kind = "ball", contact = true })"), "joints.toml:6:36",
                 "contact with a parent in a joint that has none");
  expect_refused(body("a", R"({ kind = "free", parent = "b" })"), "joints.toml:6:35",
                 "\"parent\" in [body 1.joint] is not for this kind of joint");
}

/// What the penalty response cannot do is said before it begins.
TEST(PairJointInFile, ThePenaltyResponseHoldsNoJoinedBody) {
  for (const std::string tool : {"body = \"arm\"", "body = \"finger\"", "picks = true", "body = \"other\""}) {
    const Result<Scene> scene = scene_of(body("arm", "") + body("finger", kOnArm, 0.1) +
                                         body("other", "", 1.0) + "[tool]\n" + tool + "\n");
    ASSERT_TRUE(scene) << scene.error().message();
    FrameSettings settings = scene->settings;
    EXPECT_TRUE(check_world(scene->world, settings));
    settings.response = ResponseModel::kPenalty;
    EXPECT_EQ(static_cast<bool>(check_world(scene->world, settings)), tool == "body = \"other\"") << tool;
  }
}

}  // namespace
}  // namespace tactum::pair_joint_test
