#include "tactum/dynamics/solver_choice.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pile.h"

namespace tactum::solve_iteratively_test {
namespace {

using testing::kSkin, testing::kStep, testing::leaning_stack, testing::Pile;

constexpr double kGravity = 9.81;  // [m/s^2]

struct Solver {
  NewtonSolver newton{128, 64};
  int most_sweeps = 120;

  IterativeResult operator()(Pile& pile) {
    return solve_iteratively(most_sweeps, kSkin, newton, pile.forces, pile.problem);
  }
};

/// A stack on a slope slides as one body, or holds, however high it is: forces pass through all of it.
TEST(SolveIteratively, AHighStackSlidesAsOneBody) {
  for (const std::size_t boxes : {2u, 4u, 6u, 10u, 16u, 30u})
    for (const double lean : {0.1, 0.35, 0.5})
      for (const double mu : {0.1, 0.3}) {
        const double pulled = std::min(mu, std::tan(lean));
        if (pulled * 0.5 * 0.01 * static_cast<double>(boxes) > 0.9 * 0.01) continue;  // it falls over
        Pile pile = leaning_stack(boxes, lean, mu);
        Solver solver;
        IterativeResult last;
        for (int frame = 0; frame < 30; ++frame) last = pile.frame(solver);
        EXPECT_TRUE(last.converged) << boxes << " boxes, " << lean << ", " << mu;
        const double slides = std::max(0.0, std::sin(lean) - mu * std::cos(lean)) * kGravity * kStep;
        for (std::size_t i = 0; i < boxes; ++i)
          EXPECT_NEAR(pile.speed(static_cast<int>(i)).x(), slides, 2e-3 * kGravity * kStep)
              << "box " << i << " of " << boxes << ", " << lean << ", " << mu;
      }
}

/// Bodies of ten times the mass of those that carry them.
TEST(SolveIteratively, LightBoxesCarryHeavyOnes) {
  for (const double ratio : {0.1, 10.0}) {
    constexpr std::size_t kBoxes = 8;
    Pile pile = leaning_stack(kBoxes, 0.35, 0.2);
    for (std::size_t i = 1; i < kBoxes; i += 2) {
      pile.bodies[i].mass_kg *= ratio;
      pile.bodies[i].inertia_B *= ratio;
    }
    Solver solver;
    IterativeResult last;
    for (int frame = 0; frame < 40; ++frame) last = pile.frame(solver);
    EXPECT_TRUE(last.converged) << ratio;
    const double slides = (std::sin(0.35) - 0.2 * std::cos(0.35)) * kGravity * kStep;
    for (std::size_t i = 0; i < kBoxes; ++i)
      EXPECT_NEAR(pile.speed(static_cast<int>(i)).x(), slides, 5e-3 * slides) << ratio << ", box " << i;
  }
}

/// A push on the lowest box of a row reaches the last one, and momentum is given to nobody else.
TEST(SolveIteratively, APushGoesThroughARow) {
  for (const std::size_t boxes : {3u, 8u, 20u}) {
    Pile pile(boxes);
    for (std::size_t i = 0; i < boxes; ++i) pile.X_WB[i].p = Vec3(0.01 * static_cast<double>(i), 0, 0);
    for (std::size_t i = 0; i + 1 < boxes; ++i)
      for (const double y : {-0.01, 0.01})
        for (const double z : {-0.01, 0.01})
          pile.touch(static_cast<int>(i) + 1, static_cast<int>(i),
                     Vec3(0.005 + 0.01 * static_cast<double>(i), y, z), Vec3::UnitX(), 0.0);
    pile.V[0].v = Vec3(0.1, 0, 0);
    Solver solver;
    EXPECT_TRUE(pile.frame(solver).converged) << boxes;
    double sum = 0.0;
    for (std::size_t i = 0; i < boxes; ++i) {
      const double speed = pile.speed(static_cast<int>(i)).x();
      EXPECT_NEAR(speed, 0.1 / static_cast<double>(boxes), 1e-4) << "box " << i << " of " << boxes;
      sum += speed;
    }
    EXPECT_NEAR(sum, 0.1, 1e-15) << boxes;
  }
}

TEST(SolveIteratively, WhatHasNoRoomToOpenStaysWhereItIs) {
  Pile pile(3);
  for (int i = 0; i < 3; ++i)
    for (const double side : {1.0, -1.0})
      pile.touch(i, 3, Vec3(-0.01 * side, 0.05 * i, 0), Vec3(side, 0, 0), -1e-7);
  Solver solver;
  for (int frame = 0; frame < 100; ++frame) {
    EXPECT_TRUE(pile.frame(solver).converged) << frame;
    for (int i = 0; i < 3; ++i) EXPECT_LT(pile.speed(i).norm(), 1e-7) << "m/s";
  }
}

/// With too few rounds for the answer it says so.
TEST(SolveIteratively, WhatHasNotConvergedIsNotSaidToHave) {
  int converged = 0;
  for (const std::size_t boxes : {8u, 16u, 30u}) {
    Pile pile = leaning_stack(boxes, 0.35, 0.3);
    Solver solver;
    solver.most_sweeps = 6;
    const IterativeResult result = pile.frame(solver);
    converged += result.converged ? 1 : 0;
  }
  EXPECT_EQ(converged, 0);
}

}  // namespace
}  // namespace tactum::solve_iteratively_test
