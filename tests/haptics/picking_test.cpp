#include "tactum/haptics/picking.h"

#include <gtest/gtest.h>

#include "support/sandbox.h"
#include "tactum/math/screw.h"

namespace tactum::picking_test {
namespace {

Pose at(double x, double y, double z) { return {Mat3::Identity(), {x, y, z}}; }

/// A hand with a button over two blocks on a floor.
struct Hand : Sandbox {
  Pose X_DH;
  int near_block, far_block;

  Hand() {
    world.gravity_W = {0, 0, -9.81};
    add_fixed(make_box({0.2, 0.2, 0.01}), at(0, 0, -0.01));
    near_block = add(make_box({0.01, 0.01, 0.01}), at(0, 0, 0.01001));
    far_block = add(make_box({0.01, 0.01, 0.01}), at(0.06, 0, 0.01001));
    rub(0.3);
    settings.tool.picks = true;
    settings.workspace.X_WD.p = {0, 0, 0.05};
    settings.smoothing.on = false;
  }
  /// The handle goes to a place in the world in so many frames; the largest step of the raw force.
  double go(const Vec3& p_W, int frames, bool pressed) {
    const Pose from = X_DH;
    const Pose to{Mat3::Identity(), p_W - settings.workspace.X_WD.p};
    double largest = 0.0;
    for (int i = 1; i <= frames; ++i) {
      X_DH = interpolated(from, to, static_cast<double>(i) / frames);
      DeviceSample sample;
      sample.valid = true;
      sample.X_DH = X_DH;
      sample.buttons = pressed ? 1u : 0u;
      const Vec3 before = report.coupling.f;
      step(sample);
      largest = std::max(largest, (report.coupling.f - before).norm());
    }
    return largest;
  }
};

TEST(Picking, TheNearestBodyWithinReach) {
  Hand hand;
  const auto nearest = [&](const Vec3& p, double most) {
    return nearest_body(hand.world, hand.begun().world.X_WB, p, most);
  };
  EXPECT_EQ(nearest({0.004, 0, 0.025}, 0.01), hand.near_block);
  EXPECT_EQ(nearest({0.045, 0, 0.01}, 0.01), hand.far_block);
  EXPECT_EQ(nearest({0.03, 0, 0.01}, 0.01), -1);
  EXPECT_EQ(nearest({0.03, 0, 0.01}, 0.03), hand.near_block) << "both are as near: the first";
  EXPECT_EQ(nearest({0.0, 0, -0.01}, 0.001), -1) << "the floor cannot be picked up";
}

TEST(Picking, LiftsWithoutAStepFeelsTheWeightAndThrows) {
  Hand hand;
  hand.go({0, 0, 0.025}, 200, false);
  EXPECT_EQ(hand.report.grasped_body, -1);
  EXPECT_EQ(hand.report.coupling.f.norm(), 0.0);
  EXPECT_LT(hand.go({0, 0, 0.025}, 1, true), 0.2);  // at most its weight: 78 mN
  EXPECT_EQ(hand.report.grasped_body, hand.near_block);
  hand.go({0, 0, 0.08}, 300, true);
  hand.go({0, 0, 0.08}, 300, true);
  const Body& block = hand.world.bodies[std::size_t(hand.near_block)];
  EXPECT_NEAR(hand.report.coupling.f.z(), -9.81 * block.mass_kg, 1e-6);
  EXPECT_LT(hand.report.coupling.f.head<2>().norm(), 1e-9);
  // Thrown sideways at 0.5 m/s: it flies on, and the hand feels nothing from the frame of release.
  hand.go({0, 0.1, 0.08}, 200, true);
  const Vec3 start = hand.X(hand.near_block).p;
  EXPECT_NEAR(hand.V(hand.near_block).v.y(), 0.5, 0.01);
  hand.go({0, 0.1, 0.08}, 1, false);
  EXPECT_EQ(hand.report.grasped_body, -1);
  EXPECT_EQ(hand.report.coupling.f.norm(), 0.0);
  hand.go({0, 0.1, 0.08}, 49, false);
  const Vec3 flown = hand.X(hand.near_block).p - start;
  EXPECT_NEAR(flown.y(), 0.025, 1e-3);
  EXPECT_NEAR(flown.z(), -0.5 * 9.81 * 0.05 * 0.05, 1e-3);
  hand.go({0, 0.1, 0.08}, 1000, false);
  EXPECT_NEAR(hand.X(hand.near_block).p.z(), 0.01, 1e-3) << "it lies on the floor";
  EXPECT_EQ(hand.penetrating_frames, 0);
}

TEST(Picking, ABlowOnTheHeldBlockIsFeltAsAPulseOfTheSameMomentum) {
  Hand hand;
  hand.world.gravity_W.setZero();
  const Vec3 far(0.06, 0, 0.1);
  hand.world.bodies[std::size_t(hand.far_block)].X_WB.p = far;
  hand.world.bodies[std::size_t(hand.far_block)].V_WB.v = {-1.0, 0, 0};
  hand.bounce(0.5);
  hand.settings.impacts.expansion_s = 0.02;
  hand.world.bodies[std::size_t(hand.near_block)].X_WB.p = {0, 0, 0.1};
  hand.settings.workspace.X_WD.p = {0, 0, 0.1};
  hand.go({0, 0, 0.1}, 2, true);
  ASSERT_EQ(hand.report.grasped_body, hand.near_block);
  const double mass = hand.world.bodies[std::size_t(hand.far_block)].mass_kg;
  Vec3 felt = Vec3::Zero();
  double largest = 0.0;
  for (int i = 0; i < 120; ++i) {
    hand.go({0, 0, 0.1}, 1, true);
    felt += hand.report.coupling.f * 1e-3;
    largest = std::max(largest, hand.report.coupling.f.norm());
  }
  const Vec3 lost = mass * (Vec3(-1.0, 0, 0) - hand.V(hand.far_block).v);
  EXPECT_NEAR(hand.V(hand.far_block).v.x(), 0.5, 1e-7) << "back from what is held fast, at e = 0.5";
  EXPECT_LT((felt - lost).norm(), 1e-9);  // [N s] of 0.012
  EXPECT_NEAR(largest, 2.0 * lost.norm() / 0.02, 0.05 * largest) << "spread over 20 ms";
}

}  // namespace
}  // namespace tactum::picking_test
