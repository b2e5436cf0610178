// A nut that the hand only turns follows the thread of its bolt, however fast within what a step may be.

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>

#include "support/add_body.h"
#include "support/effort.h"
#include "support/judged.h"
#include "tactum/math/screw.h"
#include "tactum/mesh/make_part.h"
#include "tactum/parts/bolt_and_nut.h"

namespace tactum::thread_test {
namespace {

std::shared_ptr<const Part> thread_part(const Result<TriangleMesh>& mesh) {
  EXPECT_TRUE(mesh) << mesh.error().message();
  Result<Part> part = part_from_mesh(*mesh, {.pieces = PieceSource::kSurface, .about_center_of_mass = true});
  EXPECT_TRUE(part) << part.error().message();
  return std::make_shared<const Part>(std::move(*part));
}

struct Turning {
  const char* size;
  double rate_rad_per_s;  // clockwise from above is down
  double rate_Hz;
};

/// Where a nut that has turned by t is at z = P t / (2 pi), within its play along the axis.
TEST(Thread, ANutFollowsItAsFastAsAHandTurns) {
  const std::vector<Turning> turnings = {{"M16", -2.0 * kPi, 1000.0}, {"M16", 2.0 * kPi, 1000.0},
                                         {"M8", -3.0 * kPi, 1000.0},  {"M6", 4.0 * kPi, 1000.0},
                                         {"M16", -4.0 * kPi, 2000.0}, {"M10", -1.0 * kPi, 500.0}};
  for (const Turning& turning : testing::sampled(turnings, 4)) {
    SCOPED_TRACE(::testing::Message()
                 << turning.size << ' ' << turning.rate_rad_per_s << ' ' << turning.rate_Hz);
    const double pitch_m = metric_screw(turning.size)->pitch_m;
    const ScrewShape shape{.size = turning.size, .length_m = 15.0 * pitch_m, .facets_per_turn = 32};
    const double facets_m = 0.5 * metric_screw(turning.size)->major_m * (1.0 - std::cos(kPi / 32.0));
    const double play_m = (screw_fit(shape)->flank_clearance_m() + facets_m) / std::cos(kPi / 6.0);
    testing::Judged judged;
    add_body(judged.world, {.part = thread_part(bolt_mesh(shape)), .joint = {.kind = JointKind::kFixed}});
    const Vec3 start(0, 0, 6.0 * pitch_m);
    const int nut = add_body(
        judged.world,
        {.part = thread_part(nut_mesh(shape)), .density_kg_per_m3 = 8000, .X_WP = {Mat3::Identity(), start}});
    judged.settings.tool.body = nut;
    judged.settings.dt_s = 1.0 / turning.rate_Hz;
    judged.begin();
    const Pose X_start = judged.X_WB(nut);
    const Vec3 off_axis(X_start.p.x(), X_start.p.y(), 0.0);
    const double turn_a_frame = turning.rate_rad_per_s / turning.rate_Hz;
    const int frames = static_cast<int>(0.6 * kPi / std::abs(turn_a_frame));
    for (int frame = 1; frame <= frames; ++frame) {
      const Mat3 turn = exp_rotation({0, 0, turn_a_frame * frame});
      judged.simulation->step(Pose{turn, turn * off_axis - off_axis});
      const Mat3 R = judged.X_WB(nut).R * X_start.R.transpose();
      const double turned = turn_about(R, Vec3::UnitZ());
      ASSERT_NEAR(turned, turn_a_frame * frame, 0.05) << frame;
      ASSERT_NEAR(judged.X_WB(nut).p.z() - X_start.p.z(), pitch_m * turned / (2.0 * kPi), play_m) << frame;
      if (frame % 20 == 0) {
        ASSERT_TRUE(judged.referee->judge(judged.simulation->state().world.X_WB).empty());
      }
    }
  }
}

}  // namespace
}  // namespace tactum::thread_test
