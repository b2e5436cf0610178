#include <gtest/gtest.h>

#include <vector>

#include "support/effort.h"
#include "tactum/haptics/frame.h"
#include "tactum/haptics/frame_hash.h"
#include "tactum/scene/builtin_scenes.h"

namespace tactum::copied_state_test {
namespace {

/// The hash of `frames` frames of a scene's own hand, from frame `first` on.
std::uint64_t hash_of(const Scene& scene, FrameState& state, int first, int frames) {
  FrameHash hash;
  for (int i = first; i < first + frames; ++i) {
    DeviceSample sample;
    sample.valid = true;
    sample.time_s = i * scene.settings.dt_s;
    sample.X_DH = scene.hand->at(sample.time_s).X_DH;
    FrameTick tick;
    tick.index = static_cast<std::uint64_t>(i);
    tick.now_s = sample.time_s;
    FrameReport report;
    haptic_frame(scene.world, scene.settings, sample, tick, state, report);
    add_to(hash, report);
    add_to(hash, state.world);
  }
  return hash.value();
}

class CopiedState : public ::testing::TestWithParam<const char*> {};

TEST_P(CopiedState, GoesOnAsItsOriginal) {
  constexpr int kStage = testing::effort(200, 40);  // frames
  for (const ResponseModel response : {ResponseModel::kConstraint, ResponseModel::kPenalty}) {
    Result<Scene> scene = open_scene(GetParam());
    ASSERT_TRUE(scene) << scene.error().message();
    scene->settings.response = response;
    FrameState state(scene->world, scene->settings);
    hash_of(*scene, state, 0, 2 * kStage);
    // The first copy is made before most contacts, so that its room is larger than its contents.
    FrameState early(state);
    hash_of(*scene, state, 2 * kStage, 8 * kStage);
    FrameState late(state);
    const std::uint64_t original = hash_of(*scene, state, 10 * kStage, 5 * kStage);
    EXPECT_EQ(hash_of(*scene, late, 10 * kStage, 5 * kStage), original);
    hash_of(*scene, early, 2 * kStage, 8 * kStage);
    EXPECT_EQ(hash_of(*scene, early, 10 * kStage, 5 * kStage), original);
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, CopiedState,
                         ::testing::ValuesIn(testing::sampled(std::vector{"block-on-plate", "gears",
                                                                          "peg-in-hole", "moving-objects",
                                                                          "lock", "gears-involute"},
                                                              2)));

}  // namespace
}  // namespace tactum::copied_state_test
