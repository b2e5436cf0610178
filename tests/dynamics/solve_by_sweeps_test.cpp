#include "tactum/dynamics/solve_by_sweeps.h"

#include <gtest/gtest.h>

#include <array>

#include "random_bodies.h"
#include "tactum/dynamics/solve_exactly.h"

namespace tactum::solve_by_sweeps_test {
namespace {

constexpr double kStep = 1e-3;
constexpr double kSkin = 1e-7;

/// Bodies of 10 g, or of a mass each; the last one does not move. With the memory from frame to frame.
struct Pile {
  std::vector<Body> bodies;
  std::vector<Pose> X_WB;
  std::vector<Twist> V;
  std::vector<ContactRow> rows;
  ContactProblem problem;
  Sweeps sweeps;
  RowMemory memory;
  FrictionAnchors anchors;

  explicit Pile(std::size_t moving)
      : bodies(moving + 1),
        X_WB(moving + 1),
        V(moving + 1),
        problem(64, moving + 1),
        sweeps(64, moving + 1),
        memory(64),
        anchors(64) {
    for (Body& body : bodies) {
      body.mass_kg = 0.01;
      body.inertia_B = 1e-6 * Mat3::Identity();
    }
    bodies.back().joint.kind = JointKind::kFixed;
  }
  /// A contact of two bodies, open by `gap_m` beyond the skin.
  void touch(int a, int b, const Vec3& p_W, const Vec3& n_BA_W, double gap_m, double friction = 0.3) {
    ContactRow row;
    row.body_a = a;
    row.body_b = b;
    row.p_W = p_W;
    row.n_BA_W = n_BA_W;
    row.distance = kSkin + gap_m;
    row.skin_m = kSkin;
    row.asked = asked_of(row, opening_share(kStep));
    row.friction = friction;
    rows.push_back(row);
  }
  RowsInProblem set(bool exact) {
    problem.clear();
    for (std::size_t i = 0; i + 1 < bodies.size(); ++i)
      problem.add_body({static_cast<int>(i), bodies[i], X_WB[i]}, X_WB[i].p,
                       inertial_metric(bodies[i], X_WB[i], kStep), to_vector(V[i] * kStep), kStep);
    problem.add_joint_rows(exact);
    const RowsInProblem contacts{rows, problem.rows()};
    for (const ContactRow& row : rows) problem.add_row(row.body_a, row.body_b, push_of(row), row.asked);
    return contacts;
  }
  RowsInProblem begin() {
    const RowsInProblem contacts = set(false);
    memory.begin();
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i].state = memory.recall(i);
    sweeps.begin(contacts, X_WB, anchors, memory, kStep, problem);
    return contacts;
  }
  void end(const RowsInProblem& contacts) {
    sweeps.keep_anchors(contacts, X_WB, problem, anchors);
    anchors.end_frame([](int) { return true; });
    sweeps.end(rows, memory);
  }
  SolverResult frame(int most_sweeps) {
    const RowsInProblem contacts = begin();
    const SolverResult result = sweeps.solve(most_sweeps, kSkin, problem);
    end(contacts);
    return result;
  }
  Vec3 speed(int body) const { return Vec3(problem.displacement(body).head<3>()) / kStep; }
};

TEST(SolveBySweeps, WhatHasNoRoomToOpenStaysWhereItIs) {
  for (const int most_sweeps : {120, 40}) {
    Pile pile(1);
    for (const double side : {1.0, -1.0}) pile.touch(0, 1, Vec3(-0.01 * side, 0, 0), Vec3(side, 0, 0), -1e-7);
    for (int frame = 0; frame < 100; ++frame) {
      EXPECT_TRUE(pile.frame(most_sweeps).converged) << frame;
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
  for (int frame = 0; frame < 100; ++frame) sweeps += pile.frame(120).iterations;
  EXPECT_LT(sweeps, 600);
  // With one wall gone there is room, and soon it is taken.
  pile.rows.pop_back();
  double fastest = 0.0;
  for (int frame = 0; frame < 20; ++frame) {
    pile.frame(120);
    fastest = std::max(fastest, pile.speed(0).x());
  }
  EXPECT_GT(fastest, 1e-6) << "m/s";
}

/// Two walls that just touch, and a second order that would have either open.
TEST(SolveBySweeps, WhatIsTightenedWithoutRoomIsNotPressedTogether) {
  Pile pile(1);
  for (const double side : {1.0, -1.0}) pile.touch(0, 1, Vec3(-0.01 * side, 0, 0), Vec3(side, 0, 0), 0.0);
  for (int frame = 0; frame < 20; ++frame) {
    const RowsInProblem contacts = pile.begin();
    pile.sweeps.solve(120, kSkin, pile.problem);
    for (const std::size_t side : {0, 1}) pile.sweeps.tighten(side, 1e-7, pile.problem);
    EXPECT_TRUE(pile.sweeps.solve(120, kSkin, pile.problem).converged);
    pile.end(contacts);
    for (const ContactRow& row : pile.rows) EXPECT_LT(row.impulse, 1e-9) << "N s";
  }
}

TEST(SolveBySweeps, WhatDoesNotPushDoesNotRub) {
  Pile pile(1);
  pile.touch(0, 1, Vec3::Zero(), Vec3(0, 0, 1), -1e-7);
  pile.V[0].v = Vec3(0.1, 0, -0.1);
  pile.frame(120);
  EXPECT_LT(pile.speed(0).x(), 0.1);
  pile.rows[0].distance = 1e-3;
  pile.rows[0].asked = -1e-3;
  pile.V[0].v = Vec3(0.1, 0, 0);
  pile.frame(120);
  EXPECT_NEAR(pile.speed(0).x(), 0.1, 1e-12);
}

/// The edge of a body that slides at 100 m/s and digs in: friction turns it down by a hundredth more than the
/// normal force lifts it, so that no force is enough while it slides.
TEST(SolveBySweeps, WhatDigsInIsPressedNoHarderForEver) {
  Pile pile(1);
  pile.touch(0, 1, Vec3(0.01, 0, -0.02), Vec3(0, 0, 1), 0.0, 1.01);
  pile.V[0].v = Vec3(100, 0, -0.01);
  const RowsInProblem contacts = pile.begin();
  pile.sweeps.solve(120, kSkin, pile.problem);
  pile.sweeps.tighten(0, 1e-12, pile.problem);  // sweeps begin again, with friction as its cone has it
  EXPECT_TRUE(pile.sweeps.solve(120, kSkin, pile.problem).converged);
  pile.end(contacts);
  EXPECT_LT(pile.sweeps.friction_force(0).norm(), 1.0 / kStep * pile.rows[0].impulse * 1.01 * (1.0 + 1e-12));
}

/// Sweeps with the friction of joints: a slider with dry friction that two bodies push.
TEST(SolveBySweeps, AJointWithDryFrictionHoldsBelowItsLimit) {
  for (const double pushed_N : {0.5, 0.9, 1.1, 2.0}) {
    Pile pile(1);
    pile.bodies[0].joint = {.kind = JointKind::kSlider, .axis_W = Vec3::UnitX(), .friction = 1.0};
    pile.V[0].v = Vec3(pushed_N * kStep / 0.01, 0, 0);
    pile.frame(120);
    EXPECT_NEAR(pile.speed(0).x(), std::max(0.0, pushed_N - 1.0) * kStep / 0.01, 1e-9);
  }
}

/// Both solvers have the same bodies, rows and cones: a stack of boxes on a floor that leans, pulled
/// sideways, from sticking to sliding.
TEST(SolveBySweeps, AgreesWithTheExactSolver) {
  for (const std::size_t boxes : {1u, 2u, 3u})
    for (const double lean : {0.0, 0.1, 0.28, 0.35, 0.6})
      for (const double mu : {0.1, 0.3, 0.5}) {
        Pile pile(boxes);
        const Vec3 gravity(9.81 * std::sin(lean), 0.0, -9.81 * std::cos(lean));
        for (std::size_t i = 0; i < boxes; ++i) {
          pile.X_WB[i].p = Vec3(0, 0, 0.005 + 0.01 * static_cast<double>(i));
          pile.V[i].v = gravity * kStep;
          const int below = i == 0 ? static_cast<int>(boxes) : static_cast<int>(i) - 1;
          for (const double x : {-0.01, 0.01})
            for (const double y : {-0.01, 0.01})
              pile.touch(static_cast<int>(i), below, Vec3(x, y, 0.01 * static_cast<double>(i)), Vec3::UnitZ(),
                         0.0, mu);
        }
        // Centres of pressure settle over frames.
        for (int frame = 0; frame < 60; ++frame) pile.frame(4000);
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
