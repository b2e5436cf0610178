/// The remedies of docs/algorithms/constraint_response.md that a setting, a number of the state or the hand
/// itself can take out: each fails without, and holds with it.

#include <gtest/gtest.h>

#include "support/block_rig.h"

namespace tactum::lessons_test {
namespace {

constexpr double kPressed_m = 0.004;  // so far the hand is below where the block can be

/// The pose that a target clipped to one step would be: of the displacement left to X, no more than `most`.
Pose clipped(const BlockRig& bench, const Pose& X, double most) {
  const Vec3 p_WD = bench.report.X_WH.p - bench.X_DH.p;
  const Vec3 proxy = bench.report.X_WH_proxy.p - p_WD;
  const Vec3 displacement = X.p - proxy;
  return {X.R, proxy + displacement * std::min(1.0, most / std::max(displacement.norm(), most))};
}

TEST(Lessons, AClippedTargetNeverPushesHarderThanOneStepsSpring) {
  for (const bool clips : {true, false}) {
    BlockRig bench;
    const double most = bench.settings.constraint.max_step_m;
    const Pose X = at(0, 0, -kBlockGap_m - kPressed_m);
    bench.step({});
    for (int i = 0; i < 100; ++i) bench.step(clips ? clipped(bench, X, most) : X);
    const double spring = bench.settings.coupling.stiffness_N_per_m;
    EXPECT_NEAR(bench.report.coupling.f.z(), spring * (clips ? most : kPressed_m + bench.skin()), 1e-6);
  }
}

TEST(Lessons, APartThatTurnsOverARimFollowsTheHandEitherWay) {
  // Linear rows let the face sink by its turn times its displacement along the rim, many skins a frame, when
  // the two are opposed; without the correction by exact gaps it would go on by halved steps, and lag.
  for (const double sense : {1.0, -1.0}) {
    BlockRig bench;
    bench.settings.coupling.stiffness_Nm_per_rad = 3.0;
    const auto hand = [&](double s) {
      return at(0.050 + sense * 0.006 * s, 0, -kBlockGap_m - 0.001, {0, 0.35 + 0.25 * s, 0});
    };
    bench.step({});
    bench.go(at(0.05, 0, 0, {0, 0.35, 0}), 300);
    bench.go(hand(0.0), 200);
    bench.go(bench.X_DH, 300);
    double lag = 0.0;
    for (int i = 1; i <= 1200; ++i) {
      bench.step(hand(std::sin(kPi * 0.01 * i)));
      lag = std::max(lag, log_rotation(bench.X_DH.R.transpose() * bench.X_WB().R).norm());
    }
    EXPECT_GT(bench.report.grasped_contact_points, 0);
    EXPECT_EQ(bench.penetrating_frames, 0);
    EXPECT_LT(lag, 0.02) << "rad, " << sense;
  }
}

TEST(Lessons, WithoutATrustedLengthThatFollowsAllIsContactThatAHandAtFullSpeedCouldMeet) {
  for (const bool follows : {false, true}) {
    BlockRig bench;
    Constraint& limits = bench.settings.constraint;
    if (!follows) limits.least_step_m = limits.max_step_m;
    bench.step({});
    bench.go(at(0, 0, -kBlockGap_m + 0.0005), 100);  // over the plate by half a longest step
    const FrameReport& report = bench.go(bench.X_DH, 20);
    EXPECT_EQ(report.contact_points > 0, !follows);
    EXPECT_EQ(report.tolerance_m > 0.0005, !follows);
  }
}

TEST(Lessons, APartThatMayNotMoveIsFeltWhereItStands) {
  BlockRig bench;
  const double spring = bench.settings.coupling.stiffness_N_per_m;
  bench.step({});
  bench.go(at(0, 0, -kBlockGap_m - 0.001), 200);
  bench.settings.budget.max_exact_tests = 0;  // nothing can be known of any step
  const Pose stands = bench.X_WB();
  bench.go(at(0, 0, -kBlockGap_m + 0.004), 200);
  bench.go(bench.X_DH, 50);
  EXPECT_LT((bench.X_WB().p - stands.p).norm(), 1e-15);
  EXPECT_NEAR(bench.report.coupling.f.z(), -spring * (0.004 - bench.skin()), 1e-6);
  bench.settings.budget.max_exact_tests = 100;
  bench.go(bench.X_DH, 200);
  EXPECT_NEAR(bench.report.coupling.f.z(), 0.0, 1e-6);
  EXPECT_EQ(bench.penetrating_frames, 0);
}

}  // namespace
}  // namespace tactum::lessons_test
