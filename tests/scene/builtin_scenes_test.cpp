#include "tactum/scene/builtin_scenes.h"
#include "support/effort.h"

#include <gtest/gtest.h>

#include <toml++/toml.h>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>

#include "scene/same_scene.h"
#include "tactum/scene/build_scene.h"
#include "tactum/scene/scene_file.h"

namespace tactum::builtin_scenes_test {
namespace {

namespace fs = std::filesystem;

/// Folders with the mesh files of the shipped scenes; empty, with a message, when they are not there.
std::vector<std::string> meshes() {
  std::vector<std::string> folders = data_folders();
  const fs::path beside = fs::path(TACTUM_SOURCE_DIR) / "../shared/data";
  if (folders.empty() && fs::is_directory(beside)) folders.push_back(beside.string());
  return folders;
}

/// A sanitized build takes long to read them: the tests of sessions, which read them as well, are enough.
bool needs_meshes(const BuiltinScene& scene) { return scene.text.find("mesh = ") != std::string_view::npos; }

/// The scene, or null with a message when its meshes are absent.
std::optional<Scene> built(const BuiltinScene& scene, std::string_view text) {
  if (needs_meshes(scene) && meshes().empty()) {
    std::cout << "the meshes of " << scene.name << " are absent (TACTUM_DATA): not built\n";
    return std::nullopt;
  }
  Result<Scene> result = parse_scene(text, std::string(scene.name), std::string(scene.name), meshes());
  EXPECT_TRUE(result) << result.error().message();
  if (!result) return std::nullopt;
  return std::move(*result);
}

TEST(BuiltinScenes, AreTheFilesOfTheScenesFolder) {
  std::size_t files = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(TACTUM_SOURCE_DIR) / "scenes"))
    files += entry.path().extension() == ".toml" ? 1 : 0;
  EXPECT_EQ(builtin_scenes().size(), files) << "a scene is missing from the registry in CMakeLists.txt";
  for (const BuiltinScene& scene : builtin_scenes()) {
    std::ifstream stream(fs::path(TACTUM_SOURCE_DIR) / "scenes" / (std::string(scene.name) + ".toml"));
    std::stringstream text;
    text << stream.rdbuf();
    EXPECT_EQ(text.str(), scene.text) << scene.name;
  }
}

TEST(BuiltinScenes, ListTellsNameAndPurpose) {
  const auto entries = list_scenes();
  ASSERT_FALSE(entries.empty());
  EXPECT_EQ(entries.front().name, "gears");
  for (const SceneEntry& entry : entries) {
    EXPECT_FALSE(entry.description.empty()) << entry.name;
    EXPECT_EQ(entry.description.find('\n'), std::string::npos) << entry.name;
  }
}

TEST(BuiltinScenes, EveryOneBuildsIsHeldAndHasSomethingToReach) {
  for (const BuiltinScene& source : builtin_scenes()) {
    if (testing::kSanitized && needs_meshes(source)) continue;
    const std::optional<Scene> scene = built(source, source.text);
    if (!scene) continue;
    const World& world = scene->world;
    EXPECT_GE(world.bodies.size(), 2u) << source.name;
    const Tool& tool = scene->settings.tool;
    ASSERT_TRUE(tool.body >= 0 || tool.picks) << source.name;
    for (const Body& body : world.bodies) {
      EXPECT_GT(body.mass_kg, 0.0) << source.name << " " << body.name;
      EXPECT_GT(body.inertia_B.determinant(), 0.0) << source.name << " " << body.name;
      EXPECT_FALSE(body.part->surface.triangles.empty());
    }
    EXPECT_FALSE(scene->goals.empty()) << source.name;
    EXPECT_FALSE(GoalRecord(world, scene->goals).all_met()) << source.name << ": done before it begins";
    // The hand starts where the handle is.
    const Pose X_WH = tool.body < 0 ? scene->settings.workspace.X_WD
                                    : world.bodies[std::size_t(tool.body)].X_WB * tool.X_BH;
    const Pose X_DH = scene->hand->at(-1.0).X_DH;
    const Workspace& space = scene->settings.workspace;
    EXPECT_LT((space.X_WD * (space.scale * X_DH.p) - X_WH.p).norm(), 2e-4)
        << source.name;  // a tremor may be on
  }
}

TEST(BuiltinScenes, GearsAreThePapers) {
  const Result<Scene> scene = open_scene("gears");
  ASSERT_TRUE(scene) << scene.error().message();
  EXPECT_EQ(scene->world.bodies[0].part->pieces.size(), 19u);
  EXPECT_EQ(scene->world.bodies[1].part->pieces.size(), 21u);
  EXPECT_GE(frames_of_motion(*scene), 12499);
  EXPECT_TRUE(scene->world.bodies[0].X_WB.p.isZero(1e-12));
  EXPECT_TRUE(scene->world.bodies[1].X_WB.p.isApprox(Vec3(0.076, 0, 0), 1e-12));
}

#if defined(__has_feature)
#if __has_feature(undefined_behavior_sanitizer)
#define TACTUM_TOML_WRITER_IS_REFUSED
#endif
#endif

TEST(BuiltinScenes, RoundTripThroughTomlChangesNoBit) {
#ifdef TACTUM_TOML_WRITER_IS_REFUSED
  // Only this test writes TOML. To guess a line's length, the library's writer casts a negative logarithm to
  // size_t.
  GTEST_SKIP()
      << "toml++ 3.3 writes small numbers with undefined behaviour of its own, which the sanitizer stops";
#endif
  for (const BuiltinScene& source : builtin_scenes()) {
    std::stringstream written;
    written << toml::parse(source.text);
    const std::optional<Scene> first = built(source, source.text);
    const std::optional<Scene> second = built(source, written.str());
    if (first && second) testing::expect_equal(*first, *second);
  }
}

TEST(BuiltinScenes, DescriptionsHoldAllThatTheirFilesSay) {
  int number = 0;
  for (const BuiltinScene& source : builtin_scenes()) {
    SCOPED_TRACE(source.name);
    if (testing::kSanitized && (needs_meshes(source) || number++ % 4 > 0)) continue;
    const std::optional<Scene> from_file = built(source, source.text);
    if (!from_file) continue;
    Result<SceneDescription> description =
        parse_description(source.text, std::string(source.name), "scene.toml", meshes());
    ASSERT_TRUE(description) << description.error().message();
    description->source.file.clear();  // as if it were made in code
    description->source.places.clear();
    const Result<Scene> from_description = build_scene(*description);
    ASSERT_TRUE(from_description) << from_description.error().message();
    testing::expect_equal(*from_file, *from_description);
  }
}

TEST(OpenScene, TakesNamesAndPathsAndSaysWhatItKnows) {
  EXPECT_TRUE(open_scene("block-on-plate"));
  EXPECT_TRUE(open_scene(std::string(TACTUM_SOURCE_DIR) + "/scenes/block-on-plate.toml"));
  EXPECT_NE(open_scene("gaers").error().message().find("expected \"gears\""), std::string::npos);
  EXPECT_NE(open_scene("nonsense-of-a-name").error().message().find("peg-in-hole"), std::string::npos);
  EXPECT_NE(open_scene("no/such.toml").error().message().find("no such file"), std::string::npos);
}

}  // namespace
}  // namespace tactum::builtin_scenes_test
