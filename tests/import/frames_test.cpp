/// <frame> and <replicate> of MJCF: the same scene as the file that has every element written out. What they
/// mean was compared with MuJoCo 3.14, since that of Debian has neither.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tactum/import/import_scene.h"
#include "tactum/scene/build_scene.h"
#include "tactum/scene/scene_file.h"

namespace tactum::import_test {
namespace {

Result<Scene> mjcf_scene(const std::string& settings, const std::string& world) {
  const Result<ImportedScene> imported =
      import_scene_text("<mujoco>" + settings + "<worldbody>" + world + "</worldbody></mujoco>", "f.xml");
  if (!imported) return imported.error();
  return parse_scene(imported->toml, "test", "test.toml", {});
}

constexpr double kSamePlace = 1e-12;  // of lengths of some metres

void expect_same_bodies(const World& ours, const World& written) {
  ASSERT_EQ(ours.bodies.size(), written.bodies.size());
  for (const Body& theirs : written.bodies) {
    SCOPED_TRACE(theirs.name);
    const auto at = std::find_if(ours.bodies.begin(), ours.bodies.end(),
                                 [&](const Body& body) { return body.name == theirs.name; });
    ASSERT_NE(at, ours.bodies.end());
    EXPECT_LT((at->X_WB.p - theirs.X_WB.p).norm(), kSamePlace);
    EXPECT_LT((at->X_WB.R - theirs.X_WB.R).norm(), kSamePlace);
    EXPECT_NEAR(at->mass_kg, theirs.mass_kg, kSamePlace);
    EXPECT_LT((at->inertia_B - theirs.inertia_B).norm(), kSamePlace);
    const Joint& joint = ours.joint_of(static_cast<int>(at - ours.bodies.begin()));
    const Joint& their_joint = written.joint_of(static_cast<int>(&theirs - written.bodies.data()));
    EXPECT_EQ(joint.kind, their_joint.kind);
    EXPECT_EQ(at->pair_joint < 0, theirs.pair_joint < 0);
    EXPECT_LT((joint.anchor_W - their_joint.anchor_W).norm(), kSamePlace);
    EXPECT_LT((joint.axis_W - their_joint.axis_W).norm(), kSamePlace);
  }
}

struct Written {
  const char* text;
  const char* written_out;
  const char* settings = "";
};

void expect_same_as_written_out(const std::vector<Written>& cases) {
  for (const Written& one : cases) {
    SCOPED_TRACE(one.text);
    const Result<Scene> ours = mjcf_scene(one.settings, one.text);
    ASSERT_TRUE(ours) << ours.error().message();
    const Result<Scene> written = mjcf_scene(one.settings, one.written_out);
    ASSERT_TRUE(written) << written.error().message();
    expect_same_bodies(ours->world, written->world);
  }
}

TEST(ImportedFrames, StandForThePosesInThem) {
  const char* kClasses = "<default><default class='heavy'><geom density='5000'/></default></default>";
  expect_same_as_written_out({
      {"<frame pos='1 2 3'><body name='b' pos='0 0 1'><freejoint/><geom size='.1'/></body></frame>",
       "<body name='b' pos='1 2 4'><freejoint/><geom size='.1'/></body>"},
      {"<frame pos='1 0 0' euler='0 0 90'><body name='b' pos='1 0 0'><joint axis='1 0 0' pos='0 .5 0'/>"
       "<geom type='box' size='.1 .2 .3'/></body></frame>",
       "<body name='b' pos='1 1 0' euler='0 0 90'><joint axis='1 0 0' pos='0 .5 0'/>"
       "<geom type='box' size='.1 .2 .3'/></body>"},
      {"<body name='b'><frame pos='0 0 1' euler='90 0 0'><joint type='slide' axis='0 1 0'/>"
       "<geom type='box' size='.1 .2 .3' pos='0 1 0'/></frame></body>",
       "<body name='b'><joint type='slide' axis='0 0 1'/>"
       "<geom type='box' size='.1 .2 .3' pos='0 0 2' euler='90 0 0'/></body>"},
      {"<body name='b'><freejoint/><frame pos='1 0 0'><frame euler='0 90 0'><geom name='g' size='.1' "
       "pos='0 0 1'/><body name='c' pos='0 0 2'><joint axis='0 0 1'/><geom size='.1'/></body></frame></frame>"
       "</body>",
       "<body name='b'><freejoint/><geom name='g' size='.1' pos='2 0 0' euler='0 90 0'/>"
       "<body name='c' pos='3 0 0' euler='0 90 0'><joint axis='0 0 1'/><geom size='.1'/></body></body>"},
      {"<frame childclass='heavy'><body name='b'><freejoint/><geom size='.1'/></body></frame>"
       "<body name='c' pos='0 0 1'><freejoint/><geom size='.1'/></body>",
       "<body name='b'><freejoint/><geom size='.1' density='5000'/></body>"
       "<body name='c' pos='0 0 1'><freejoint/><geom size='.1'/></body>",
       kClasses},
      {"<frame pos='0 0 -1'><geom name='floor' type='box' size='1 1 .5'/></frame><body name='b' pos='0 0 1'>"
       "<freejoint/><geom size='.1'/></body>",
       "<geom name='floor' type='box' size='1 1 .5' pos='0 0 -1'/><body name='b' pos='0 0 1'><freejoint/>"
       "<geom size='.1'/></body>"},
  });
}

TEST(ImportedFrames, ReplicasFollowEachOther) {
  expect_same_as_written_out({
      {"<replicate count='3' offset='0 0 1'><body name='b'><freejoint/><geom size='.1'/></body></replicate>",
       "<body name='b0'><freejoint/><geom size='.1'/></body>"
       "<body name='b1' pos='0 0 1'><freejoint/><geom size='.1'/></body>"
       "<body name='b2' pos='0 0 2'><freejoint/><geom size='.1'/></body>"},
      // Each turns and moves in the frame of the one before it: three sides of a square.
      {"<replicate count='3' sep='-' offset='2 0 0' euler='0 0 90'><body name='b' pos='0 0 1'><freejoint/>"
       "<geom type='box' size='.1 .2 .3'/></body></replicate>",
       "<body name='b-0' pos='0 0 1'><freejoint/><geom type='box' size='.1 .2 .3'/></body>"
       "<body name='b-1' pos='2 0 1' euler='0 0 90'><freejoint/><geom type='box' size='.1 .2 .3'/></body>"
       "<body name='b-2' pos='2 2 1' euler='0 0 180'><freejoint/><geom type='box' size='.1 .2 .3'/></body>"},
      // In each other: the inner number comes first in the names.
      {"<replicate count='2' sep='r' offset='1 0 0'><replicate count='2' sep='c' offset='0 1 0'><body "
       "name='b'>"
       "<freejoint/><geom size='.1'/></body></replicate></replicate>",
       "<body name='bc0r0'><freejoint/><geom size='.1'/></body>"
       "<body name='bc1r0' pos='0 1 0'><freejoint/><geom size='.1'/></body>"
       "<body name='bc0r1' pos='1 0 0'><freejoint/><geom size='.1'/></body>"
       "<body name='bc1r1' pos='1 1 0'><freejoint/><geom size='.1'/></body>"},
      // Of geoms in a body, and of bodies that hang on it.
      {"<body name='hub'><joint axis='0 0 1'/><geom size='.2'/><replicate count='4' euler='0 0 90'>"
       "<geom type='box' size='.3 .01 .05' pos='.5 0 0'/></replicate></body>",
       "<body name='hub'><joint axis='0 0 1'/><geom size='.2'/>"
       "<geom type='box' size='.3 .01 .05' pos='.5 0 0'/>"
       "<geom type='box' size='.3 .01 .05' pos='0 .5 0' euler='0 0 90'/>"
       "<geom type='box' size='.3 .01 .05' pos='-.5 0 0' euler='0 0 180'/>"
       "<geom type='box' size='.3 .01 .05' pos='0 -.5 0' euler='0 0 270'/></body>"},
      {"<body name='hub'><joint axis='0 0 1'/><geom size='.2'/><replicate count='2' euler='0 0 "
       "3.141592653589793'>"
       "<body name='arm' pos='1 0 0'><joint axis='0 1 0'/><geom type='box' size='.1 .2 "
       ".3'/></body></replicate>"
       "</body>",
       "<body name='hub'><joint axis='0 0 1'/><geom size='.2'/>"
       "<body name='arm0' pos='1 0 0'><joint axis='0 1 0'/><geom type='box' size='.1 .2 .3'/></body>"
       "<body name='arm1' pos='-1 0 0' euler='0 0 3.141592653589793'><joint axis='0 1 0'/>"
       "<geom type='box' size='.1 .2 .3'/></body></body>",
       "<compiler angle='radian'/>"},
  });
}

/// tests/import/files/frames.xml as MuJoCo 3.14 reads it: names, masses and centres of mass.
TEST(ImportedFrames, AreThoseOfMujocosReading) {
  const Result<ImportedScene> imported =
      import_scene(fmt::format("{}/tests/import/files/frames.xml", TACTUM_SOURCE_DIR));
  ASSERT_TRUE(imported) << imported.error().message();
  EXPECT_TRUE(imported->notes.empty());
  const Result<Scene> scene = parse_scene(imported->toml, "test", "test.toml", {});
  ASSERT_TRUE(scene) << scene.error().message();
  struct Read {
    const char* name;
    double mass_kg;
    Vec3 center_W;
  };
  const std::vector<Read> wanted{
      {"wheel", 1.117079633, {0, 0, 0.5}},       {"ball0-0", 0.523598776, {0, 0, 1.1}},
      {"ball1-0", 0.523598776, {0, 0.5, 1.1}},   {"ball0-1", 0.523598776, {0.5, 0, 1.1}},
      {"ball1-1", 0.523598776, {0.5, 0.5, 1.1}}, {"ball0-2", 0.523598776, {1, 0, 1.1}},
      {"ball1-2", 0.523598776, {1, 0.5, 1.1}}};
  const std::vector<Body>& bodies = scene->world.bodies;
  EXPECT_EQ(bodies.size(), wanted.size() + 1);  // and the bench's top, which does not move
  for (const Read& theirs : wanted) {
    const auto ours = std::find_if(bodies.begin(), bodies.end(),
                                   [&](const Body& body) { return body.name == theirs.name; });
    ASSERT_NE(ours, bodies.end()) << theirs.name;
    EXPECT_NEAR(ours->mass_kg, theirs.mass_kg, 1e-9);
    EXPECT_LT((ours->X_WB.p - theirs.center_W).norm(), 1e-9) << theirs.name;
  }
}

/// As in MuJoCo the numbers in names have the digits of the count, and what a replica holds is told once.
TEST(ImportedFrames, ReplicasAreNamedAndToldAsOne) {
  const Result<ImportedScene> imported = import_scene_text(
      "<mujoco><worldbody>\n<replicate count='10' offset='1 0 0'>\n<body name='b'><freejoint/>\n<geom "
      "size='.1' "
      "rgba='1 0 0 1'/>\n<site/></body></replicate></worldbody></mujoco>",
      "f.xml");
  ASSERT_TRUE(imported) << imported.error().message();
  std::vector<std::string> notes;
  for (const ImportNote& note : imported->notes) notes.push_back(note.sentence());
  EXPECT_EQ(notes, (std::vector<std::string>{"f.xml:4: \"rgba\" of <geom> is not honoured",
                                             "f.xml:5: <site> is not honoured"}));
  for (const char* name : {"\"b00\"", "\"b05\"", "\"b09\""})
    EXPECT_NE(imported->toml.find(name), std::string::npos) << name;
}

TEST(ImportedFrames, ReplicasWithoutEndAreRefusedWithTheirLine) {
  const auto error = [](const std::string& world) {
    const Result<ImportedScene> imported =
        import_scene_text("<mujoco><worldbody>\n" + world + "</worldbody></mujoco>", "f.xml");
    return imported ? "no error" : imported.error().message();
  };
  for (const char* count : {"", "count='0'", "count='-2'", "count='1.5'", "count='1000001'"})
    EXPECT_EQ(error(fmt::format("<replicate {}/>", count)).substr(0, 27), "f.xml:2: how many replicas:")
        << count;
  std::string nested = "<geom size='.1'/>";
  for (int i = 0; i < 12; ++i) nested = "<replicate count='10'>" + nested + "</replicate>";
  EXPECT_EQ(error(nested).substr(0, 26), "f.xml:2: too many replicas");
}

}  // namespace
}  // namespace tactum::import_test
