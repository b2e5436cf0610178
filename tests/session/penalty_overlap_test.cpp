// In the published response the grasped part overlaps what it presses, by the force over the stiffness. That
// overlap ends with the grasp: bodies that nobody holds do not overlap, and what the hand has released inside
// another body is moved out.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "support/effort.h"
#include "tactum/haptics/frame.h"
#include "tactum/scene/builtin_scenes.h"

namespace tactum::penalty_overlap_test {
namespace {

constexpr double kOpen_m = 10e-6;
constexpr double kMoveOut_s = 0.3;

class PenaltyOverlap : public ::testing::TestWithParam<const char*> {};

TEST_P(PenaltyOverlap, EndsWithTheGrasp) {
  Result<Scene> scene = open_scene(GetParam());
  ASSERT_TRUE(scene) << scene.error().message();
  scene->settings.response = ResponseModel::kPenalty;
  FrameState state(scene->world, scene->settings);
  FrameReport report;
  std::vector<double> last_grasped_s(scene->world.bodies.size(), -1.0);
  double most_of_grasped_m = 0.0;
  int releases = 0;
  const double end_s = testing::effort(1.0, 0.25) * scene->hand->duration_s();
  for (int i = 0; i * scene->settings.dt_s < end_s; ++i) {
    DeviceSample sample;
    sample.valid = true;
    sample.time_s = i * scene->settings.dt_s;
    const HandState hand = scene->hand->at(sample.time_s);
    sample.X_DH = hand.X_DH;
    sample.buttons = hand.buttons;
    const int grasped_before = report.grasped_body;
    haptic_frame(scene->world, scene->settings, sample, {.index = std::uint64_t(i), .now_s = sample.time_s},
                 state, report);
    releases += grasped_before >= 0 && report.grasped_body < 0 ? 1 : 0;
    if (report.grasped_body >= 0) last_grasped_s[std::size_t(report.grasped_body)] = sample.time_s;
    for (const ContactPatch& patch : state.contacts.finder.patches()) {
      const double grasped_s =
          std::max(last_grasped_s[std::size_t(patch.body_a)], last_grasped_s[std::size_t(patch.body_b)]);
      if (grasped_s == sample.time_s) most_of_grasped_m = std::max(most_of_grasped_m, -patch.distance);
      const bool released_long_ago = grasped_s < 0.0 || sample.time_s - grasped_s > kMoveOut_s;
      ASSERT_TRUE(!released_long_ago || patch.distance > -kOpen_m)
          << scene->world.bodies[std::size_t(patch.body_a)].name << " and "
          << scene->world.bodies[std::size_t(patch.body_b)].name << " overlap by " << -patch.distance
          << " m at " << sample.time_s << " s";
    }
  }
  EXPECT_GT(most_of_grasped_m, testing::effort(kOpen_m, -1.0)) << "the hand presses nothing";
  if (scene->settings.tool.picks) {
    EXPECT_GT(releases, testing::effort(0, -1));
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, PenaltyOverlap,
                         ::testing::Values("scale", "moving-objects", "lock", "dominoes"),
                         [](const ::testing::TestParamInfo<const char*>& run) {
                           std::string name = run.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace tactum::penalty_overlap_test
