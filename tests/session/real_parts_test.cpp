#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "support/effort.h"
#include "support/real_data.h"
#include "tactum/scene/builtin_scenes.h"
#include "tactum/session/session.h"
#include "tactum/surface/surface_distance.h"

namespace tactum::real_parts_test {
namespace {

/// Looks at every so many frames by the exact distance of the triangles as they stand in the meshes, which
/// knows nothing of minima, cones and pieces.
class Referee final : public LoopObserver {
 public:
  Referee(const Session& session, std::uint64_t every) : session_(session), every_(every) {
    for (const Body& body : session.scene().world.bodies) surfaces_.emplace_back(body.part->surface);
    caches_.resize(surfaces_.size() * surfaces_.size());
  }

  bool after_frame(const FrameRecord& record) noexcept override {
    follow_thread(session_.state().world.X_WB[static_cast<std::size_t>(session_.scene().settings.tool.body)]);
    if (record.tick.index % every_ == 0) look();
    return true;
  }

  int crossing = 0;           ///< frames and pairs whose surfaces share a point
  double least_m = 1e9;       ///< smallest distance [m]
  double turned_rad = 0.0;    ///< of the grasped part about z, since it was first pushed [rad]
  double off_thread_m = 0.0;  ///< farthest that it was off a right-hand thread of 2 mm meanwhile [m]

 private:
  void look() noexcept {
    const World& world = session_.scene().world;
    const std::vector<Pose>& X_WB = session_.state().world.X_WB;
    for (std::size_t a = 0; a < surfaces_.size(); ++a) {
      for (std::size_t b = a + 1; b < surfaces_.size(); ++b) {
        if (!world.bodies[a].moves() && !world.bodies[b].moves()) continue;
        const SurfaceDistance found =
            surface_distance(surfaces_[a], surfaces_[b], relative_pose(X_WB[a], X_WB[b]),
                             caches_[a * surfaces_.size() + b], TouchingPairs::kFirst);
        crossing += found.touching_pairs > 0 ? 1 : 0;
        least_m = std::min(least_m, found.distance);
      }
    }
  }

  void follow_thread(const Pose& X_WB) noexcept {
    const double angle = std::atan2(X_WB.R(1, 0), X_WB.R(0, 0));
    if (session_.last_report().grasped_contact_points > 0 && !riding_) {
      riding_ = true;
      z_first_ = X_WB.p.z();
    } else if (riding_) {
      turned_rad += std::remainder(angle - last_angle_, 2.0 * kPi);
      if (session_.last_report().grasped_contact_points > 0)
        off_thread_m =
            std::max(off_thread_m, std::abs(X_WB.p.z() - z_first_ - 0.002 * turned_rad / (2.0 * kPi)));
    }
    last_angle_ = angle;
  }

  const Session& session_;
  std::uint64_t every_;
  std::vector<Surface> surfaces_;
  std::vector<SurfacePairCache> caches_;
  bool riding_ = false;
  double z_first_ = 0.0, last_angle_ = 0.0;
};

struct Case {
  const char* scene;
  std::uint64_t sample;  ///< frames of the short test, in contact at the end; 0: all
  std::uint64_t every;   ///< ... of which so many are passed by from look to look
};
constexpr std::uint64_t kSlowness = testing::kSanitized ? 20 : 1;

class RealParts : public ::testing::TestWithParam<Case> {};

TEST_P(RealParts, AreFeltWithoutEverCrossing) {
  if (!testing::real_data().empty()) setenv("TACTUM_DATA", testing::real_data().c_str(), 0);
  const std::string name = GetParam().scene;
  if (name.find("-file") != std::string::npos) TACTUM_NEEDS_REAL_DATA();
  Result<Scene> scene = open_scene(name);
  ASSERT_TRUE(scene) << scene.error().message();
  ASSERT_EQ(scene->settings.response, ResponseModel::kConstraint);
  Result<std::unique_ptr<Session>> opened = Session::open(std::move(*scene), {});
  ASSERT_TRUE(opened);
  Session& session = **opened;
  const auto all = static_cast<std::uint64_t>(frames_of_motion(session.scene()));
  const std::uint64_t sample = GetParam().sample == 0 ? all : GetParam().sample;
  const std::uint64_t frames = testing::full_run() ? all : std::min(all, sample) / kSlowness;
  Referee referee(session, testing::full_run() ? 1 : GetParam().every);
  ASSERT_TRUE(session.run_virtual(frames, &referee));

  const RunRecord& record = session.record();
  std::printf(
      "%s: %llu of %llu frames pushed; never nearer than %.1f nm; %llu minima, at most %.0f a frame\n",
      name.c_str(), static_cast<unsigned long long>(record.grasped_contact_frames),
      static_cast<unsigned long long>(frames), referee.least_m * 1e9,
      static_cast<unsigned long long>(record.sum("work.minima")), record.largest("work.minima"));
  EXPECT_EQ(referee.crossing, 0);
  EXPECT_GT(referee.least_m, 0.0);
  EXPECT_EQ(record.penetrating_frames, 0u);
  EXPECT_EQ(record.non_finite_frames, 0u);
  EXPECT_EQ(record.flags & ~(frame_flag::kLags | frame_flag::kPathUnproven), 0u);
  if (kSlowness == 1) {
    EXPECT_GT(record.grasped_contact_frames, frames / 20) << "or nothing was felt";
  }
  if (name.find("nut") != std::string::npos) {
    // The nut follows the thread, and the thread alone: the hand does not move along the axis.
    std::printf("%s: turned by %.1f degrees, off the thread by at most %.1f um\n", name.c_str(),
                referee.turned_rad * 180.0 / kPi, referee.off_thread_m * 1e6);
    EXPECT_LT(referee.off_thread_m, 3e-5);
  }
  for (std::size_t i = 0; frames == all && i < session.scene().goals.size(); ++i)
    EXPECT_TRUE(session.goals().met(i)) << session.goals().describe(session.scene().world, i);
}

INSTANTIATE_TEST_SUITE_P(Scenes, RealParts,
                         ::testing::Values(Case{"peg-tight-file", 0, 1}, Case{"peg-round-file", 2600, 1},
                                           Case{"nut-bolt", 1400, 10}, Case{"nut-bolt-file", 820, 20},
                                           Case{"gears-involute", 0, 1}, Case{"gears-file", 450, 2}),
                         [](const ::testing::TestParamInfo<Case>& run) {
                           std::string name = run.param.scene;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace tactum::real_parts_test
