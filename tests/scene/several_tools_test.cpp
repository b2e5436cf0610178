/// [[tool]] in scene files: several hands, each with what belongs to it.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tactum/scene/build_scene.h"
#include "tactum/scene/scene_file.h"

namespace tactum::several_tools_test {
namespace {

const std::string kBodies = R"(schema = 1
[[body]]
name = "a"
part = { box = { size_m = [0.02, 0.02, 0.02] } }
[[body]]
name = "b"
part = { box = { size_m = [0.02, 0.02, 0.02] } }
pos_m = [0.1, 0, 0]
)";

Result<Scene> read(const std::string& tools, const std::string& head = "") {
  return parse_scene(head + kBodies + tools, "two", "two.toml", {});
}

TEST(SeveralTools, EachHasItsHandAndItsDevice) {
  const Result<Scene> scene = read(R"(
[coupling]
stiffness_N_per_m = 450
[[tool]]
body = "a"
[hand]
step = [{ hold_s = 1.0 }]
[[tool]]
body = "b"
device = "touch"
[tool.workspace]
rpy_deg = [0, 0, 90]
[tool.hand]
grip = "loose"
step = [{ offset_m = [0.01, 0, 0], duration_s = 2.0 }]
[[tool]]
picks = true
pick_distance_m = 0.03
)");
  ASSERT_TRUE(scene) << scene.error().message();
  const FrameSettings& settings = scene->settings;
  ASSERT_EQ(settings.hands(), 3u);
  EXPECT_EQ(settings.hand(0).tool.body, 0);
  EXPECT_EQ(settings.hand(1).tool.body, 1);
  EXPECT_EQ(settings.hand(2).tool.body, -1);
  EXPECT_TRUE(settings.hand(2).tool.picks);
  EXPECT_EQ(settings.hand(2).tool.pick_distance_m, 0.03);
  EXPECT_EQ(settings.hand(1).coupling.stiffness_N_per_m, 450.0);
  EXPECT_EQ(settings.hand(1).workspace.X_WD.p, Vec3(0.1, 0, 0));  // where its handle starts
  EXPECT_LT((settings.hand(1).workspace.X_WD.R.col(0) - Vec3::UnitY()).norm(), 1e-12);
  ASSERT_EQ(scene->other_hands.size(), 2u);
  EXPECT_EQ(scene->other_hands[0].device, "touch");
  EXPECT_EQ(scene->other_hands[0].grip, "loose");
  EXPECT_EQ(scene->other_hands[0].hand->duration_s(), 2.0);
  EXPECT_LT((scene->other_hands[0].hand->at(2.0).X_DH.p - Vec3(0, -0.01, 0)).norm(), 1e-12);
  EXPECT_EQ(scene->hand->duration_s(), 1.0);
}

/// Two hands, each with limits, coupling and smoothing of its own, on a plate.
const std::string kOwn = R"(
[[body]]
name = "plate"
part = { box = { size_m = [0.4, 0.4, 0.02] } }
pos_m = [0, 0, -0.03]
joint = { kind = "fixed" }
[safety]
max_force_N = 4
[smoothing]
reversal_N_per_s = 30
[[tool]]
body = "a"
[tool.safety]
max_force_N = 5
max_torque_Nm = 0.1
[[tool]]
body = "b"
[tool.coupling]
stiffness_N_per_m = 300
[tool.smoothing]
reversal_N_per_s = 60
[tool.safety]
max_force_N = 2
[tool.workspace]
scale = 2
clutch_button = 3
pos_m = [0.1, 0, 0]
)";

DeviceInfo premium() {
  DeviceInfo info;
  info.actuates_force = info.actuates_torque = true;
  info.max_force_N = 8.5;
  info.max_torque_Nm = 0.188;
  info.handle.damping_Ns_per_m = 0.05;
  return info;
}

TEST(SeveralTools, EachMayHaveSettingsOfItsOwn) {
  const Result<Scene> scene = read(kOwn);
  ASSERT_TRUE(scene) << scene.error().message();
  const std::vector<DeviceInfo> devices(2, premium());
  const FrameSettings settings = settings_for(*scene, devices);
  EXPECT_EQ(settings.hand(0).safety.max_force_N, 4.0) << "the scene's is tighter";
  EXPECT_EQ(settings.hand(0).safety.max_torque_Nm, 0.1);
  EXPECT_EQ(settings.hand(1).safety.max_force_N, 2.0);
  EXPECT_EQ(settings.hand(1).safety.max_torque_Nm, 0.188);
  EXPECT_EQ(settings.hand(0).smoothing.reversal_N_per_s, 30.0);
  EXPECT_EQ(settings.hand(1).smoothing.reversal_N_per_s, 60.0);
  EXPECT_EQ(settings.hand(1).smoothing.max_force_N_per_s, settings.hand(0).smoothing.max_force_N_per_s);
  EXPECT_GT(settings.hand(0).coupling.stiffness_N_per_m, 1000.0) << "chosen by the device";
  EXPECT_EQ(settings.hand(1).coupling.stiffness_N_per_m, 300.0);
  EXPECT_EQ(settings.hand(1).coupling.damping_Ns_per_m, Coupling{}.damping_Ns_per_m)
      << "left out: its default";
  EXPECT_EQ(settings.hand(0).workspace.scale, 1.0);
  EXPECT_EQ(settings.hand(1).workspace.scale, 2.0);
  EXPECT_EQ(settings.hand(1).workspace.clutch_button, 3);
  EXPECT_EQ(settings.hand(0).workspace.clutch_button, -1);
}

TEST(SeveralTools, AnOwnSettingIsCheckedAsAnyOther) {
  const auto error = [](const std::string& tools) {
    const Result<Scene> scene = read(tools);
    EXPECT_FALSE(scene) << tools;
    return scene ? std::string() : scene.error().message();
  };
  const std::string two = "[[tool]]\nbody = \"a\"\n[[tool]]\nbody = \"b\"\n";
  EXPECT_NE(error(two + "[tool.coupling]\nstiffness_N_per_m = 1e9\n").find("two.toml:14"), std::string::npos);
  EXPECT_NE(error(two + "[tool.safety]\nmax_force = 1\n").find("max_force_N"), std::string::npos);
  EXPECT_NE(error(two + "[tool.budget]\nsleep = true\n").find("budget"), std::string::npos);
  EXPECT_NE(error("[[tool]]\nbody = \"a\"\n[tool.coupling]\nstiffness_N_per_m = 5\n" + two.substr(20))
                .find("coupling"),
            std::string::npos);
  Result<SceneDescription> scene = parse_description(kBodies + kOwn, "two", "two.toml", {});
  ASSERT_TRUE(scene);
  EXPECT_TRUE(build_scene(*scene));
  for (const OwnSetting& wrong :
       {OwnSetting{"budget.sleep", 0.0}, OwnSetting{"coupling.stiffnes", 1.0}, OwnSetting{"", 1.0},
        OwnSetting{"safety.max_force_N", -1.0}, OwnSetting{"coupling.stiffness_N_per_m", 1e9}}) {
    SceneDescription changed = *scene;
    changed.other_hands[0].hand.own = {wrong};
    EXPECT_FALSE(build_scene(changed)) << wrong.setting;
  }
}

TEST(SeveralTools, OneInAnArrayIsTheOneTool) {
  const Result<Scene> one = read("[tool]\nbody = \"b\"\n");
  const Result<Scene> array = read("[[tool]]\nbody = \"b\"\n");
  ASSERT_TRUE(one && array);
  EXPECT_EQ(array->settings.hands(), 1u);
  EXPECT_EQ(array->settings.tool.body, one->settings.tool.body);
  EXPECT_EQ(array->settings.workspace.X_WD.p, one->settings.workspace.X_WD.p);
}

TEST(SeveralTools, ErrorsNameTheToolAndItsLine) {
  const auto error = [](const std::string& tools, const std::string& head = "") {
    const Result<Scene> scene = read(tools, head);
    EXPECT_FALSE(scene) << tools;
    return scene ? std::string() : scene.error().message();
  };
  const std::string first = "[[tool]]\nbody = \"a\"\n[[tool]]\n";
  EXPECT_NE(error(first + "body = \"c\"\n").find("two.toml:12"), std::string::npos);
  EXPECT_NE(error(first + "body = \"b\"\nbodi = 1\n").find("\"bodi\""), std::string::npos);
  EXPECT_NE(error(first + "body = \"b\"\ndevice = \"touhc\"\n").find("touch"), std::string::npos);
  EXPECT_NE(error(first + "body = \"b\"\n[tool.hand]\nstep = [{ offset_m = [9, 0, 0], duration_s = 1 }]\n")
                .find("leaves the workspace"),
            std::string::npos);
}

TEST(SeveralTools, ADescriptionHasNoSecondWithoutAFirst) {
  Result<SceneDescription> scene = parse_description(kBodies, "two", "two.toml", {});
  ASSERT_TRUE(scene);
  scene->other_hands.push_back({.tool = BodyTool{.body = "b"}});
  const Result<Scene> built = build_scene(*scene);
  ASSERT_FALSE(built);
  EXPECT_NE(built.error().message().find("no first"), std::string::npos);
  scene->tool = BodyTool{.body = "a"};
  EXPECT_TRUE(build_scene(*scene));
}

}  // namespace
}  // namespace tactum::several_tools_test
