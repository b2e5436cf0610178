#include "tactum/dynamics/solve_by_sweeps.h"

#include <gtest/gtest.h>

#include <array>

#include "pile.h"
#include "random_bodies.h"
#include "tactum/dynamics/solve_exactly.h"

namespace tactum::solve_by_sweeps_test {
namespace {

using testing::kSkin, testing::kStep, testing::Pile;

auto by_sweeps(int most) {
  return [most](Pile& pile) {
    pile.forces.begin_solution(pile.problem);
    return solve_by_sweeps(most, kSkin, pile.forces, pile.problem);
  };
}

TEST(SolveBySweeps, WhatHasNoRoomToOpenStaysWhereItIs) {
  for (const int most_sweeps : {120, 40}) {
    Pile pile(1);
    for (const double side : {1.0, -1.0}) pile.touch(0, 1, Vec3(-0.01 * side, 0, 0), Vec3(side, 0, 0), -1e-7);
    for (int frame = 0; frame < 100; ++frame) {
      EXPECT_TRUE(pile.frame(by_sweeps(most_sweeps)).converged) << frame;
      EXPECT_LT(pile.speed(0).norm(), 1e-7) << "m/s";
      EXPECT_LT(pile.rows[0].impulse, 1e-9) << "N s: pressed together by nothing, frame " << frame;
    }
  }
}

/// The sweeps in vain are not made in every frame.
TEST(SolveBySweeps, WhatHadNoRoomIsSeldomAskedAgain) {
  Pile pile(1);
  for (const double side : {1.0, -1.0}) pile.touch(0, 1, Vec3(-0.01 * side, 0, 0), Vec3(side, 0, 0), -1e-7);
  int sweeps = 0;
  for (int frame = 0; frame < 100; ++frame) sweeps += pile.frame(by_sweeps(120)).iterations;
  EXPECT_LT(sweeps, 600);
  // With one wall gone there is room, and soon it is taken.
  pile.rows.pop_back();
  double fastest = 0.0;
  for (int frame = 0; frame < 20; ++frame) {
    pile.frame(by_sweeps(120));
    fastest = std::max(fastest, pile.speed(0).x());
  }
  EXPECT_GT(fastest, 1e-6) << "m/s";
}

/// Two walls that just touch, and a correction that would have either open.
TEST(SolveBySweeps, WhatIsCorrectedWithoutRoomIsNotPressedTogether) {
  Pile pile(1);
  for (const double side : {1.0, -1.0}) pile.touch(0, 1, Vec3(-0.01 * side, 0, 0), Vec3(side, 0, 0), 0.0);
  for (int frame = 0; frame < 20; ++frame) {
    for (ContactRow& row : pile.rows) row.asked = 1e-7;
    EXPECT_TRUE(pile.frame(by_sweeps(120)).converged);
    for (const ContactRow& row : pile.rows) EXPECT_LT(row.impulse, 1e-9) << "N s";
  }
}

TEST(SolveBySweeps, WhatDoesNotPushDoesNotRub) {
  Pile pile(1);
  pile.touch(0, 1, Vec3::Zero(), Vec3(0, 0, 1), -1e-7);
  pile.V[0].v = Vec3(0.1, 0, -0.1);
  pile.frame(by_sweeps(120));
  EXPECT_LT(pile.speed(0).x(), 0.1);
  pile.rows[0].distance = 1e-3;
  pile.rows[0].asked = -1e-3;
  pile.V[0].v = Vec3(0.1, 0, 0);
  pile.frame(by_sweeps(120));
  EXPECT_NEAR(pile.speed(0).x(), 0.1, 1e-12);
}

/// The edge of a body that slides at 100 m/s and digs in: friction turns it down by a hundredth more than the
/// normal force lifts it, so that no force is enough while it slides.
TEST(SolveBySweeps, WhatDigsInIsPressedNoHarderForEver) {
  Pile pile(1);
  pile.touch(0, 1, Vec3(0.01, 0, -0.02), Vec3(0, 0, 1), 0.0, 1.01);
  pile.V[0].v = Vec3(100, 0, -0.01);
  EXPECT_TRUE(pile.frame(by_sweeps(120)).converged);
  EXPECT_LT(pile.forces.friction_force(0).norm(), 1.0 / kStep * pile.rows[0].impulse * 1.01 * (1.0 + 1e-12));
}

/// Sweeps with the friction of joints: a slider with dry friction that two bodies push.
TEST(SolveBySweeps, AJointWithDryFrictionHoldsBelowItsLimit) {
  for (const double pushed_N : {0.5, 0.9, 1.1, 2.0}) {
    Pile pile(1);
    pile.bodies[0].joint = {.kind = JointKind::kSlider, .axis_W = Vec3::UnitX(), .friction = 1.0};
    pile.V[0].v = Vec3(pushed_N * kStep / 0.01, 0, 0);
    pile.frame(by_sweeps(120));
    EXPECT_NEAR(pile.speed(0).x(), std::max(0.0, pushed_N - 1.0) * kStep / 0.01, 1e-9);
  }
}

/// Both solvers have the same bodies, rows and cones: a stack of boxes on a floor that leans, pulled
/// sideways, from sticking to sliding.
TEST(SolveBySweeps, AgreesWithTheExactSolver) {
  for (const std::size_t boxes : {1u, 2u, 3u})
    for (const double lean : {0.0, 0.1, 0.28, 0.35, 0.6})
      for (const double mu : {0.1, 0.3, 0.5}) {
        Pile pile = testing::leaning_stack(boxes, lean, mu);
        // Centres of pressure settle over frames.
        for (int frame = 0; frame < 60; ++frame) pile.frame(by_sweeps(4000));
        std::vector<Vec3> swept;
        for (std::size_t i = 0; i < boxes; ++i) swept.push_back(pile.speed(static_cast<int>(i)));
        ExactStart start;
        Friction friction;
        FrictionAnchors anchors(64);
        for (int frame = 0; frame < 60; ++frame) {
          const RowsInProblem contacts = pile.set(true);
          ASSERT_TRUE(
              solve_exactly(contacts, {pile.X_WB, anchors}, 1000, start, friction, pile.problem).solved);
          friction.end(contacts, pile.problem, pile.X_WB, anchors);
          anchors.end_frame([](int) { return true; });
        }
        // Lengths below a quarter of the skin count as zero, in either solver.
        const double slides = std::max(0.0, std::sin(lean) - mu * std::cos(lean)) * 9.81 * kStep;
        for (std::size_t i = 0; i < boxes; ++i) {
          EXPECT_NEAR(pile.speed(static_cast<int>(i)).x(), slides, kSkin / kStep)
              << boxes << " " << lean << " " << mu;
          EXPECT_NEAR(swept[i].x(), slides, kSkin / kStep) << boxes << " " << lean << " " << mu;
          EXPECT_NEAR(swept[i].z(), pile.speed(static_cast<int>(i)).z(), kSkin / kStep);
        }
      }
}

}  // namespace
}  // namespace tactum::solve_by_sweeps_test
