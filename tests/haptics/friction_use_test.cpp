#include "tactum/response/friction_use.h"

#include <gtest/gtest.h>

#include "support/block_rig.h"

namespace tactum::friction_use_test {
namespace {

/// Pressed flat on the plate with about three newtons.
BlockRig pressed(double mu) {
  BlockRig bench(mu);
  bench.settings.coupling.stiffness_Nm_per_rad = 3.0;
  bench.step({});
  bench.go(at(0, 0, -0.008), 100);
  return bench;
}

TEST(FrictionUse, IsTheShareOfTheConeWhileItSticksAndAllOfItWhileItSlips) {
  for (const double mu : {0.1, 0.3, 0.6})
    for (const double share : {0.25, 0.5, 0.9, 1.5}) {
      BlockRig bench = pressed(mu);
      const double load = bench.report.coupling.f.z();
      const double pull = share * mu * load / bench.settings.coupling.stiffness_N_per_m;
      const FrameReport& report = bench.go(at(0.6 * pull, -0.8 * pull, -0.008), 60);
      ASSERT_EQ(bench.simulation->state().response.friction_uses().size(), 1u);
      const FrictionUse& use = bench.simulation->state().response.friction_uses()[0];
      const double sideways = report.coupling.f.head<2>().norm();
      EXPECT_NEAR(use.load_N, report.coupling.f.z(), 1e-9 * load);
      EXPECT_NEAR(use.sideways_N, sideways, 1e-9 * load);
      EXPECT_EQ(use.sticks, share < 1.0) << mu << " " << share;
      EXPECT_EQ(report.friction.sticking, share < 1.0 ? 1 : 0);
      EXPECT_EQ(report.friction.slipping, share < 1.0 ? 0 : 1);
      EXPECT_EQ(report.friction.cone_used, use.cone_used);
      EXPECT_NEAR(use.cone_used, sideways / (mu * use.load_N), 1e-6);
      EXPECT_NEAR(use.cone_used, std::min(1.0, share), 0.01) << mu << " " << share;
      EXPECT_GT(report.grasped_contact_points, 0) << "also when the cone carries all of the load";
      for (const ContactRow& row : bench.simulation->state().response.rows())
        EXPECT_TRUE(row.friction_patch == 0 || row.impulse == 0.0) << "what pushes belongs to the patch";
    }
}

TEST(FrictionUse, TurningOnTheSpotUsesItToo) {
  const double mu = 0.3;
  BlockRig bench = pressed(mu);
  const double limit = mu * bench.report.coupling.f.z() * kBlockHalf.head<2>().norm();
  bench.go(at(0, 0, -0.008, {0, 0, 0.5 * limit / 3.0}), 100);
  const FrictionUse half = bench.simulation->state().response.friction_uses()[0];
  EXPECT_TRUE(half.sticks);
  EXPECT_NEAR(half.twisting_Nm, -bench.report.coupling.t.z(), 1e-6 * limit);
  EXPECT_NEAR(half.cone_used, 0.5, 0.05);
  bench.go(at(0, 0, -0.008, {0, 0, 2.0 * limit / 3.0}), 100);
  EXPECT_FALSE(bench.simulation->state().response.friction_uses()[0].sticks);
  EXPECT_GT(bench.report.friction.cone_used, 0.99);
}

TEST(FrictionUse, NothingIsToldWhereNothingRubs) {
  BlockRig smooth;
  smooth.step({});
  smooth.go(at(0.001, 0, -0.008), 100);
  EXPECT_TRUE(smooth.simulation->state().response.friction_uses().empty());
  EXPECT_EQ(smooth.report.friction.sticking + smooth.report.friction.slipping, 0);
  BlockRig lifted = pressed(0.3);
  EXPECT_EQ(lifted.report.friction.sticking, 1);
  lifted.go(at(0, 0, 0.01), 300);
  EXPECT_TRUE(lifted.simulation->state().response.friction_uses().empty());
  EXPECT_EQ(lifted.report.friction.sticking, 0);
}

}  // namespace
}  // namespace tactum::friction_use_test
