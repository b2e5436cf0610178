/// A program can contain everything that a scene file can: the same frames, to the bit.

#include <gtest/gtest.h>

#include <cmath>

#include "session/scenes_in_code.h"
#include "support/effort.h"
#include "tactum/drivers/registry.h"
#include "tactum/scene/builtin_scenes.h"
#include "tactum/session/session.h"

namespace tactum::scene_in_code_test {
namespace {

/// The hash of the scene's first frames, and the state of its goals; 0 frames: as long as the hand moves.
std::uint64_t hash_of(const SceneDescription& scene, std::uint64_t frames, bool& all_met) {
  Result<std::unique_ptr<Session>> session = Session::open(scene, {});
  EXPECT_TRUE(session) << session.error().message();
  if (!session) return 0;
  if (frames == 0) frames = static_cast<std::uint64_t>(frames_of_motion((*session)->scene()));
  EXPECT_TRUE((*session)->run_virtual(frames, nullptr));
  all_met = (*session)->goals().all_met();
  return (*session)->record().hash();
}

struct Kind {
  const char* name;
  SceneDescription (*in_code)();
  std::uint64_t frames;
};

TEST(SceneInCode, GivesTheFramesOfItsFile) {
  for (Kind kind :
       {Kind{"block-on-plate", testing::block_on_plate, 0},
        Kind{"peg-round-h7g6", testing::peg_round_h7g6, 0},
        Kind{"nut-bolt", testing::nut_bolt, 500},  // a thread costs a hundred pegs
        Kind{"dipole-field", testing::dipole_field, 0}, Kind{"gears-pick", testing::gears_pick, 0},
        Kind{"lock", testing::lock, 0}, Kind{"dominoes", testing::dominoes, 0}}) {
    SCOPED_TRACE(kind.name);
    if (testing::kSanitized) kind.frames = 200;
    const Result<SceneDescription> file = describe_scene(kind.name);
    ASSERT_TRUE(file) << file.error().message();
    bool met_of_file = false, met_in_code = true;
    EXPECT_EQ(hash_of(*file, kind.frames, met_of_file), hash_of(kind.in_code(), kind.frames, met_in_code));
    EXPECT_EQ(met_of_file, met_in_code);
    EXPECT_EQ(met_of_file, kind.frames == 0);
  }
}

TEST(SceneInCode, OpensWithADeviceOfTheCallers) {
  SceneDescription scene = testing::block_on_plate();
  scene.hand.steps.clear();
  Result<std::unique_ptr<Device>> device = make_device("simulated:touch", {});
  ASSERT_TRUE(device);
  Result<std::unique_ptr<Session>> session = Session::open_with(scene, std::move(*device), 2000.0);
  ASSERT_TRUE(session) << session.error().message();
  EXPECT_EQ((*session)->rate_Hz(), 2000.0);
  scene.tool = BodyTool{.body = "blokc"};
  device = make_device("simulated:touch", {});
  session = Session::open_with(scene, std::move(*device));
  ASSERT_FALSE(session);
  EXPECT_EQ(session.error().message(),
            "tool.body: no body of this name, in tool: found \"blokc\", expected \"block\"");
}

TEST(SceneInCode, BodiesStartWithTheVelocityOfTheirDescription) {
  SceneDescription scene;
  scene.bodies = {{.name = "puck", .part = PrismPart{16, 0.02, 0.01}, .V_WB = {{0.3, 0, 0}, {0, 0, 2.0}}}};
  Result<std::unique_ptr<Session>> session = Session::open(scene, {});
  ASSERT_TRUE(session) << session.error().message();
  ASSERT_TRUE((*session)->run_virtual(100, nullptr));
  const WorldState& state = (*session)->state().world;
  EXPECT_NEAR(state.X_WB[0].p.x(), 0.3 * 0.1, 1e-9);
  EXPECT_NEAR(std::atan2(state.X_WB[0].R(1, 0), state.X_WB[0].R(0, 0)), 2.0 * 0.1, 1e-9);
}

}  // namespace
}  // namespace tactum::scene_in_code_test
