/// What is not honoured is told with its line, and what is malformed is refused with it.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "app/program.h"
#include "tactum/import/import_scene.h"
#include "tactum/scene/build_scene.h"
#include "tactum/scene/scene_file.h"

namespace tactum::import_test {
namespace {

std::vector<std::string> notes_of(const std::string& text, const std::string& file) {
  const Result<ImportedScene> imported = import_scene_text(text, file);
  if (!imported) return {imported.error().message()};
  std::vector<std::string> notes;
  for (const ImportNote& note : imported->notes) notes.push_back(note.sentence());
  return notes;
}

TEST(ImportNotes, EveryTagAndAttributeOfUrdf) {
  const std::string text = R"(<robot name="r" version="1">
  <material name="grey"><color rgba="1 1 1 1"/></material>
  <link name="a">
    <visual><geometry><box size="1 1 1"/></geometry></visual>
    <collision group="3"><geometry><box size="1 1 1" colour="red"/></geometry></collision>
  </link>
  <link name="b">
    <visual><geometry><sphere radius="0.1"/></geometry></visual>
  </link>
  <joint name="j" type="revolute">
    <parent link="a"/><child link="b"/>
    <limit lower="-1" upper="1" effort="5" velocity="2"/>
    <mimic joint="k"/>
  </joint>
  <transmission name="t"/>
</robot>
)";
  EXPECT_EQ(notes_of(text, "r.urdf"), (std::vector<std::string>{
                                          "r.urdf:1: \"version\" of <robot> is not honoured",
                                          "r.urdf:2: <material> is not honoured, nor what it holds",
                                          "r.urdf:4: <visual> is not honoured, nor what it holds",
                                          "r.urdf:5: \"group\" of <collision> is not honoured",
                                          "r.urdf:5: \"colour\" of <box> is not honoured",
                                          "r.urdf:7: \"b\" has no <collision>: its <visual> is felt",
                                          "r.urdf:12: \"effort\" of <limit> is not honoured",
                                          "r.urdf:12: \"velocity\" of <limit> is not honoured",
                                          "r.urdf:13: <mimic> is not honoured",
                                          "r.urdf:15: <transmission> is not honoured",
                                      }));
}

TEST(ImportNotes, EveryTagAndAttributeOfMjcf) {
  const std::string text = R"(<mujoco model="m">
  <option timestep="0.002" gravity="0 0 -1"><flag energy="enable"/></option>
  <default><geom rgba="1 0 0 1" density="10"/><motor ctrlrange="0 1"/></default>
  <worldbody>
    <light pos="0 0 1"/>
    <geom type="plane" size="1 1 1"/>
    <body name="b" pos="0 0 1">
      <joint type="slide" armature="1"/>
      <joint type="hinge" damping="2"/>
      <geom size="0.1" friction="1 0.005 0.1" contype="2"/>
      <site name="s"/>
      <composite type="cable" count="3 1 1"><geom size="0.1"/></composite>
      <flexcomp name="f" type="grid" count="2 2 2"/>
    </body>
  </worldbody>
  <actuator><motor joint="b"/></actuator>
</mujoco>
)";
  EXPECT_EQ(notes_of(text, "m.xml"),
            (std::vector<std::string>{
                "m.xml:2: \"timestep\" of <option> is not honoured",
                "m.xml:2: \"energy\" of <flag> is not honoured",
                "m.xml:3: \"rgba\" of <geom> is not honoured",
                "m.xml:3: <motor> is not honoured",
                "m.xml:5: <light> is not honoured",
                "m.xml:6: a plane is felt as the upper side of a plate",
                "m.xml:8: \"armature\" of <joint> is not honoured",
                "m.xml:9: a body has one joint here: \"b\" is held by the one in line 8 alone",
                "m.xml:10: bits of contype and conaffinity beyond 1 are not honoured: it touches everything",
                "m.xml:10: torsional and rolling friction are not honoured",
                "m.xml:11: <site> is not honoured",
                "m.xml:12: <composite> is not honoured, nor what it holds",
                "m.xml:13: <flexcomp> is not honoured",
                "m.xml:16: <actuator> is not honoured, nor what it holds",
            }));
}

std::string error_of(const std::string& text, const std::string& file) {
  const Result<ImportedScene> imported = import_scene_text(text, file);
  return imported ? "no error" : imported.error().message();
}

struct Case {
  const char* text;
  const char* error;
};

const std::vector<Case> kMalformed{
    Case{"", "f.xml:"},
    Case{"<mujoco>\n<worldbody>\n</mujoco>", "f.xml:2: an element ends with another name"},
    Case{"<mujoco>\n<worldbody\n x=>\n</mujoco>", "f.xml:"},
    Case{"<sdf/>", "f.xml:1: neither URDF nor MJCF: found <sdf>"},
    Case{"<robot/>\n<robot/>", "f.xml:2: the file has a second root element"},
    Case{"<robot name='a'\n name='b'/>", "f.xml:2: an attribute is not name=\"value\", or stands twice"},
    Case{"<robot/>", "f.xml:1: the robot has no <link>"},
    Case{"<robot>\n<link/>\n</robot>", "f.xml:2: a <link> without a name"},
    Case{"<robot>\n<link name='a'/>\n<link name='a'/></robot>", "f.xml:3: two links of one name"},
    Case{"<robot><link name='a'/>\n<link name='b'/>\n</robot>", "f.xml:2: a second link that hangs on no"},
    Case{"<robot><link name='a'/>\n<joint type='fixed'><parent link='a'/>\n<child "
         "link='aa'/></joint></robot>",
         "f.xml:3: the joint's child is no link: found \"aa\""},
    Case{"<robot><link name='a'/><link name='b'/>\n<joint type='revolut'><parent link='a'/><child "
         "link='b'/></joint></robot>",
         "f.xml:2: \"type\" of <joint> is none of its words: found \"revolut\", expected \"revolute\""},
    Case{"<robot><link name='a'/><link name='b'/>\n<joint type='fixed'><parent link='a'/><child "
         "link='b'/></joint>\n<joint type='fixed'><parent link='b'/><child link='a'/></joint></robot>",
         "f.xml:1: the joints go in a circle"},
    Case{"<robot>\n<link name='a'><collision>\n<geometry><box size='1 "
         "1'/></geometry></collision></link></robot>",
         "f.xml:3: \"size\" of <box> is wrong: found \"1 1\", expected 3 numbers"},
    Case{"<robot>\n<link name='a'><collision>\n<geometry><mesh "
         "filename='no.stl'/></geometry></collision>"
         "</link></robot>",
         "f.xml:3: the mesh is not there: found \"no.stl\""},
    Case{"<mujoco/>", "f.xml:1: the model has no <worldbody>"},
    Case{"<mujoco><worldbody>\n<body><freejoint/></body></worldbody></mujoco>",
         "f.xml:2: \"body 1\" moves and has no mass"},
    Case{"<mujoco><worldbody>\n<geom type='box' size='1 1'/></worldbody></mujoco>",
         "f.xml:2: a geom without a size"},
    Case{"<mujoco><worldbody>\n<geom size='1' pos='0 0 x'/></worldbody></mujoco>",
         "f.xml:2: \"pos\" of <geom>"},
    Case{"<mujoco><worldbody>\n<geom size='1e999'/></worldbody></mujoco>", "f.xml:2: \"size\" of <geom>"},
    Case{"<mujoco><worldbody>\n<geom size='1' class='no'/></worldbody></mujoco>", "f.xml:2: no class"},
    Case{"<mujoco><worldbody>\n<geom type='mesh' mesh='no'/></worldbody></mujoco>", "f.xml:2: no mesh"},
    Case{"<mujoco><worldbody>\n<geom size='1' quat='0 0 0 0'/></worldbody></mujoco>",
         "f.xml:2: an orientation of length 0"},
    Case{"<mujoco><worldbody>\n<geom size='1' euler='0 0 0' zaxis='1 0 0'/></worldbody></mujoco>",
         "f.xml:2: several orientations"},
    Case{"<mujoco><worldbody><body><joint/>\n<inertial mass='1' pos='0 0 "
         "0'/></body></worldbody></mujoco>",
         "f.xml:2: an <inertial> without an inertia"},
    Case{"<mujoco><worldbody>\n<body><joint/><inertial mass='1' pos='0 0 0' diaginertia='1 1 9'/></body>"
         "</worldbody></mujoco>",
         "f.xml:2: no body has the inertia"},
    Case{"<mujoco>\n<compiler coordinate='global'/></mujoco>", "f.xml:2: poses in the axes of the world"},
    Case{"<mujoco>\n<include file='no.xml'/></mujoco>", "f.xml:2: the included file cannot be read"},
};

TEST(ImportErrors, MalformedFilesAreRefusedWithTheirLine) {
  for (const Case& bad : kMalformed)
    EXPECT_EQ(error_of(bad.text, "f.xml").substr(0, std::string(bad.error).size()), bad.error) << bad.text;
}

TEST(ImportErrors, AFileThatIncludesItselfEnds) {
  const testing::ScratchFolder folder;
  testing::write(folder / "a.xml", "<mujoco><include file=\"a.xml\"/><include file=\"a.xml\"/></mujoco>");
  const Result<ImportedScene> imported = import_scene(folder / "a.xml");
  ASSERT_FALSE(imported);
  EXPECT_NE(imported.error().message().find("too many included files"), std::string::npos);
}

TEST(ImportErrors, IncludedElementsAreNoDeeperThanThoseOfOneFile) {
  const testing::ScratchFolder folder;
  std::string deep = "<include file=\"a.xml\"/>";
  for (int i = 0; i < 300; ++i) deep = "<body>" + deep + "</body>";
  testing::write(folder / "a.xml", "<mujoco>" + deep + "</mujoco>");
  const Result<ImportedScene> imported = import_scene(folder / "a.xml");
  ASSERT_FALSE(imported);
  EXPECT_NE(imported.error().message().find("too deep"), std::string::npos) << imported.error().message();
}

Result<Scene> scene_of(const ImportedScene& imported) {
  return parse_scene(imported.toml, "test", "test.toml", {});
}

TEST(ImportedScenes, TheHandHoldsWhatIsFreeElseTheEndOfTheChain) {
  const std::string folder = fmt::format("{}/tests/import/files/", TACTUM_SOURCE_DIR);
  const auto grasped = [&](const char* file, const std::string& tool) {
    const Result<ImportedScene> imported = import_scene(folder + file, {.tool = tool, .folder = {}});
    if (!imported) return imported.error().what;
    const Result<Scene> scene = scene_of(*imported);
    if (!scene) return scene.error().message();
    return scene->world.bodies[static_cast<std::size_t>(scene->settings.tool.body)].name;
  };
  EXPECT_EQ(grasped("arm.urdf", ""), "wheel");
  EXPECT_EQ(grasped("arm.urdf", "lower"), "lower");
  EXPECT_EQ(grasped("shapes.urdf", ""), "thing");
  EXPECT_EQ(grasped("arm.urdf", "lowr"), "no body of this name");
  EXPECT_EQ(grasped("arm.urdf", "base"), "the hand cannot hold a body that never moves");
}

TEST(ImportedScenes, WeldedLinksAreOneBodyAndMeshesStayWhatTheyAre) {
  const std::string folder = fmt::format("{}/tests/import/files/", TACTUM_SOURCE_DIR);
  const Result<ImportedScene> arm = import_scene(folder + "arm.urdf");
  ASSERT_TRUE(arm);
  const Result<Scene> scene = scene_of(*arm);
  ASSERT_TRUE(scene) << scene.error().message();
  ASSERT_EQ(scene->world.bodies.size(), 4u);  // base, upper, lower with flange and probe, wheel
  EXPECT_NEAR(scene->world.bodies[2].mass_kg, 1.9, 1e-12);
  EXPECT_EQ(scene->world.bodies[2].part->pieces.size(), 3u);

  const Result<ImportedScene> shapes = import_scene(folder + "shapes.urdf");
  ASSERT_TRUE(shapes);
  const Result<Scene> thing = scene_of(*shapes);
  ASSERT_TRUE(thing) << thing.error().message();
  // The L is cut in two boxes, not covered by its hull.
  EXPECT_EQ(thing->world.bodies.back().part->pieces.size(), 3u);
}

TEST(ImportedScenes, FrictionOfTwoBodiesIsTheLarger) {
  const Result<ImportedScene> imported = import_scene_text(
      "<mujoco><worldbody><geom type='box' size='1 1 1' friction='0.2'/><body pos='0 0 2'><freejoint/>"
      "<geom size='0.1' friction='0.7'/></body></worldbody></mujoco>",
      "f.xml");
  ASSERT_TRUE(imported);
  const Result<Scene> scene = scene_of(*imported);
  ASSERT_TRUE(scene) << scene.error().message();
  EXPECT_EQ(scene->settings.friction.between(0, 1), 0.7);
}

/// The only moving body of a model with these settings and this joint.
Result<Scene> one_body(const std::string& settings, const std::string& joint) {
  const Result<ImportedScene> imported =
      import_scene_text("<mujoco>" + settings + "<worldbody><body name='b'>" + joint +
                            "<geom size='0.1'/></body></worldbody></mujoco>",
                        "f.xml");
  if (!imported) return imported.error();
  return scene_of(*imported);
}

TEST(ImportedScenes, ARangeLimitsAJointWhereTheCompilerSaysSo) {
  const auto limited = [](const std::string& compiler, const std::string& joint) {
    const Result<Scene> scene =
        one_body("<compiler " + compiler + "/>", "<joint " + joint + " range='-30 60'/>");
    EXPECT_TRUE(scene) << scene.error().message();
    return scene && scene->world.joint_of(0).limited();
  };
  EXPECT_TRUE(limited("", ""));
  EXPECT_TRUE(limited("autolimits='true'", ""));
  EXPECT_FALSE(limited("autolimits='false'", ""));
  EXPECT_TRUE(limited("autolimits='false'", "limited='true'"));
  EXPECT_FALSE(limited("autolimits='true'", "limited='false'"));
  EXPECT_TRUE(limited("autolimits='true'", "limited='auto'"));
}

TEST(ImportedScenes, GravityIsWhatTheOptionAndItsFlagSay) {
  const auto gravity = [](const std::string& option) {
    const Result<Scene> scene = one_body(option, "<freejoint/>");
    EXPECT_TRUE(scene) << scene.error().message();
    return scene ? scene->world.gravity_W : Vec3(NAN, NAN, NAN);
  };
  EXPECT_EQ(gravity(""), Vec3(0, 0, -9.81));
  EXPECT_EQ(gravity("<option gravity='1 2 3'/>"), Vec3(1, 2, 3));
  EXPECT_EQ(gravity("<option gravity='1 2 3'><flag gravity='enable'/></option>"), Vec3(1, 2, 3));
  EXPECT_EQ(gravity("<option gravity='1 2 3'><flag gravity='disable'/></option>"), Vec3(0, 0, 0));
  EXPECT_EQ(gravity("<option><flag gravity='disable'/></option>"), Vec3(0, 0, 0));
}

/// A slider that starts at its nearest limit is that many metres along its axis, of whatever length.
TEST(ImportedScenes, AJointStartsAtItsNearestLimitWhateverTheLengthOfItsAxis) {
  for (const char* axis : {"0 0 1", "0 0 5", "0.3 0 0.4", "-1 2 2", "0 0 -0.01"}) {
    const Result<Scene> scene =
        one_body("", fmt::format("<joint type='slide' axis='{}' range='0.2 0.7'/>", axis));
    ASSERT_TRUE(scene) << scene.error().message();
    const Joint& joint = scene->world.joint_of(0);
    EXPECT_LT((scene->world.bodies[0].X_WB.p - 0.2 * joint.axis_W).norm(), 1e-12) << axis;
    EXPECT_NEAR(joint.lower, 0.0, 1e-12);
    EXPECT_NEAR(joint.upper, 0.5, 1e-12);
  }
}

TEST(ImportedScenes, AJointOfUrdfThatNamesNoAxisHasX) {
  for (const char* kind : {"revolute", "continuous", "prismatic"}) {
    const char* kLink =
        "<link name='{}'><collision><geometry><sphere radius='1'/></geometry></collision></link>";
    const std::string links = fmt::format(fmt::runtime(kLink), "a") + fmt::format(fmt::runtime(kLink), "b");
    const std::string joint = fmt::format(
        "<joint name='j' type='{}'><parent link='a'/><child link='b'/><origin rpy='0 0 "
        "1.5707963267948966'/></joint>",
        kind);
    const Result<ImportedScene> imported =
        import_scene_text("<robot>" + links + joint + "</robot>", "r.urdf");
    ASSERT_TRUE(imported) << imported.error().message();
    const Result<Scene> scene = scene_of(*imported);
    ASSERT_TRUE(scene) << scene.error().message();
    EXPECT_LT((scene->world.joint_of(1).axis_W - Vec3::UnitY()).norm(), 1e-12) << kind;
  }
}

TEST(ImportedScenes, PackagesAreFoundAboveTheFileAndInTheEnvironment) {
  const testing::ScratchFolder folder;
  std::filesystem::create_directories(folder / "robot/urdf");
  std::filesystem::create_directories(folder / "robot/meshes");
  std::filesystem::copy_file(fmt::format("{}/tests/import/files/ell.obj", TACTUM_SOURCE_DIR),
                             folder / "robot/meshes/ell.obj");
  const std::string text =
      "<robot><link name='a'><collision><geometry><mesh "
      "filename='package://robot/meshes/ell.obj'/></geometry>"
      "</collision></link></robot>";
  testing::write(folder / "robot/urdf/r.urdf", text);
  EXPECT_TRUE(import_scene(folder / "robot/urdf/r.urdf"));
  testing::write(folder / "r.urdf", text);
  EXPECT_TRUE(import_scene(folder / "r.urdf"));
  testing::write(folder / "robot/urdf/no.urdf",
                 "<robot><link name='a'><collision><geometry><mesh "
                 "filename='package://other/ell.obj'/></geometry></collision></link></robot>");
  EXPECT_FALSE(import_scene(folder / "robot/urdf/no.urdf"));
}

}  // namespace
}  // namespace tactum::import_test
