#include "tactum/response/constraint.h"

#include <gtest/gtest.h>

#include <iostream>

#include "support/block_rig.h"
#include "tactum/base/random.h"
#include "tactum/haptics/frame.h"
#include "tactum/math/screw.h"

namespace tactum::constraint_test {
namespace {

TEST(Constraint, PressedFlatTheForceIsTheCouplingsAlone) {
  BlockRig bench;
  const double pressed = 0.004;
  bench.step({});
  bench.go(at(0, 0, -0.003 - pressed), 200);
  const FrameReport& report = bench.go(bench.X_DH, 50);
  EXPECT_NEAR(report.coupling.f.z(), 600.0 * (pressed + bench.skin()), 1e-6);
  EXPECT_LT(report.coupling.f.head<2>().norm(), 1e-6);
  EXPECT_LT(report.coupling.t.norm(), 1e-6);
  EXPECT_FALSE(report.penetrating);
  EXPECT_NEAR(report.min_distance_m, bench.skin(), 1e-10);
}

TEST(Constraint, TiltedWhilePressedTheTorqueIsTheCouplingsAlone) {
  BlockRig bench;
  const Vec3 turn(0.02, -0.03, 0.0);
  bench.step({});
  bench.go(at(0, 0, -0.013, turn), 200);
  const FrameReport& report = bench.go(bench.X_DH, 50);
  EXPECT_NEAR(report.coupling.f.z(), 600.0 * (0.010 + bench.skin()), 1e-6);
  EXPECT_LT((report.coupling.t + 0.3 * turn).norm(), 1e-6);
  EXPECT_LT((bench.X_WB().R - Mat3::Identity()).norm(), 1e-9);
}

TEST(Constraint, FreeMotionIsNotFeltHoweverFast) {
  BlockRig bench;
  bench.step({});
  for (int i = 1; i <= 40; ++i) {
    const FrameReport& report = bench.step(at(0.005 * i, 0, 0.002 * i, {0.05 * i, 0, 0}));
    EXPECT_LT(report.coupling.f.norm(), 1e-9);
    EXPECT_LT(report.coupling.t.norm(), 1e-9);
  }
  bench.go(bench.X_DH, 300);
  EXPECT_LT((bench.report.X_WH_proxy.p - bench.report.X_WH.p).norm(), 1e-9) << "it arrives";
}

TEST(Constraint, ContactForcesAddUpToWhatIsFelt) {
  constexpr std::uint64_t kSeed = 31;
  std::cout << "seed " << kSeed << "\n";
  for (const double mu : {0.0, 0.3}) {
    Random random(kSeed);
    BlockRig bench(mu);
    bench.settings.tool.X_BH.p = {0.004, 0.002, 0.005};
    bench.step({});
    int touching = 0;
    for (int move = 0; move < 60; ++move) {
      const Vec3 turn(random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), random.uniform(-0.5, 0.5));
      const double x = random.uniform(-0.02, 0.02);
      const double z = random.uniform(-0.012, 0.0);
      const Pose from = bench.X_DH;
      const Pose to = at(x, -0.5 * x, z, turn);
      for (int i = 1; i <= 40; ++i) {
        bench.step(interpolated(from, to, i / 40.0));
        const double force = 1.0 + bench.report.coupling.f.norm();  // [N]: to 1e-9 of the felt force
        EXPECT_LT(bench.unaccounted().f.norm(), 1e-9 * force);
        EXPECT_LT(bench.unaccounted().t.norm(), 1e-9 * force);
        EXPECT_FALSE(bench.report.penetrating);
        touching += bench.report.grasped_contact_points > 0 ? 1 : 0;
      }
    }
    EXPECT_GT(touching, 800);
  }
}

TEST(Constraint, SlidingIsHeldBackByMuTimesTheLoad) {
  for (const double mu : {0.1, 0.3, 0.6})
    for (const double heading : {0.0, 0.7, 2.0}) {
      BlockRig bench(mu);
      bench.settings.coupling.stiffness_Nm_per_rad = 3.0;
      bench.step({});
      bench.go(at(0, 0, -0.005), 100);
      const Vec3 direction(std::cos(heading), std::sin(heading), 0.0);
      const Vec3 end = 0.02 * direction;
      const FrameReport& report = bench.go(at(end.x(), end.y(), -0.005), 400);
      const double load = report.coupling.f.z();
      EXPECT_GT(load, 1.0);
      EXPECT_NEAR(-report.coupling.f.dot(direction), mu * load, 0.01 * mu * load) << mu << " " << heading;
    }
}

TEST(Constraint, BelowTheConeItSticksAndDoesNotCreep) {
  const double mu = 0.3;
  BlockRig bench(mu);
  bench.settings.coupling.stiffness_Nm_per_rad = 3.0;
  bench.step({});
  bench.go(at(0, 0, -0.008), 100);
  bench.go(at(0.0005, 0, -0.008), 100);  // a tenth of the load sideways
  const Vec3 before = bench.X_WB().p;
  Random random(5);
  for (int i = 0; i < 2000; ++i)  // an unsteady hand
    bench.step(at(0.0005 + random.uniform(-5e-5, 5e-5), 0, -0.008 + random.uniform(-5e-5, 5e-5),
                  {0, 0, random.uniform(-1e-3, 1e-3)}));
  const Vec3 crept = bench.X_WB().p - before;
  EXPECT_LT(crept.head<2>().norm() / 2.0, 1e-6) << "m/s";
  EXPECT_NEAR(bench.report.coupling.f.x(), -600.0 * (bench.X_DH.p.x() - bench.X_WB().p.x()), 1e-6);
}

TEST(Constraint, TurningOnTheSpotIsHeldBackByThePatchsRadius) {
  const double mu = 0.3;
  BlockRig bench(mu);
  bench.step({});
  bench.go(at(0, 0, -0.008), 100);
  const double load = bench.report.coupling.f.z();
  const double limit = mu * load * kBlockHalf.head<2>().norm();  // carried by its corners
  bench.go(at(0, 0, -0.008, {0, 0, 0.5 * limit / 0.3}), 100);
  EXPECT_LT(std::abs(log_rotation(bench.X_WB().R).z()), 1e-4) << "half the limit does not turn it";
  bench.go(at(0, 0, -0.008, {0, 0, 3.0 * limit / 0.3}), 300);
  EXPECT_NEAR(-bench.report.coupling.t.z(), limit, 0.1 * limit);
}

TEST(Constraint, AGapBelowTheSkinOpensAndStillLetsItSlide) {
  BlockRig bench;
  const double skin = bench.skin();
  bench.simulation.reset();
  bench.world.bodies[0].X_WB.p.z() = kBlockHalf.z() + 0.1 * skin;
  bench.step({});
  EXPECT_NEAR(bench.X_WB().p.z() - kBlockHalf.z(), skin, 1e-3 * skin) << "opened first";
  // Pressed as close as half the skin, and slid from there.
  bench.go(at(0.01, 0, -0.004, {0.3, 0.2, 0.1}), 200);
  EXPECT_NEAR(bench.X_WB().p.x(), 0.01, 2e-3);
  EXPECT_GT(bench.report.min_distance_m, 0.25 * skin);
}

TEST(Constraint, AStepIsNeverLongerThanSet) {
  BlockRig bench;
  bench.step({});
  bench.go(at(0, 0, -0.010), 100);
  Vec3 last = bench.X_WB().p;
  for (int i = 0; i < 60; ++i) {  // leave the plate at once, and fast
    bench.step(at(0.03, 0, 0.03));
    EXPECT_LE((bench.X_WB().p - last).norm(), bench.settings.constraint.max_step_m + 1e-12);
    last = bench.X_WB().p;
  }
  EXPECT_LT((last - Vec3(0.03, 0, 0.038)).norm(), 1e-9);
}

}  // namespace
}  // namespace tactum::constraint_test
