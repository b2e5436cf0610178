#include "tactum/dynamics/solve_penalty.h"

#include <gtest/gtest.h>

#include <array>
#include <utility>

#include "random_bodies.h"
#include "tactum/dynamics/step.h"

namespace tactum::solve_penalty_test {
namespace {

using test::random_body;
using test::random_vector;

constexpr double kStep = 1e-3;

/// Bodies with targets and contacts between them.
struct Case {
  std::vector<Body> bodies;
  std::vector<Twist> V;  ///< targets over the step
  std::vector<ContactRow> rows;

  Vec6 displacement(const ContactProblem& problem, std::size_t body) const {
    return problem.displacement(static_cast<int>(body));
  }
  ContactProblem solve(SolverResult& result, int sweeps = 0) {
    ContactProblem problem(rows.size(), bodies.size());
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const Pose& X_WB = bodies[i].X_WB;
      if (bodies[i].joint.kind != JointKind::kFixed)
        problem.add_body({static_cast<int>(i), bodies[i], X_WB}, X_WB.p,
                         inertial_metric(bodies[i], X_WB, kStep), to_vector(V[i] * kStep), kStep);
    }
    problem.add_joint_rows(false);
    const std::size_t first = problem.rows();
    std::vector<double> stiffness;
    for (const ContactRow& row : rows) {
      problem.add_row(row.body_a, row.body_b, push_of(row), row.margin - row.distance);
      stiffness.push_back(row.stiffness);
    }
    PenaltySolver solver(problem.rows() + bodies.size());
    result = solver.solve(stiffness, sweeps, problem);
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i].impulse = solver.forces()[first + i] * kStep;
    return problem;
  }
};

ContactRow random_row(Random& random, int bodies) {
  ContactRow row;
  row.body_a = static_cast<int>(random.uniform(0, bodies));
  row.body_b = (row.body_a + 1 + static_cast<int>(random.uniform(0, bodies - 1))) % bodies;
  row.n_BA_W = random_vector(random, 1).normalized();
  row.p_W = random_vector(random, 0.03);
  row.distance = random.uniform(-1e-4, 4e-4);
  row.margin = 3e-4;
  row.stiffness = random.uniform(100, 5000);
  return row;
}

/// Bodies that are free, turn on a hinge, slide, turn about a point, or are fixed, named in any order. The
/// law at the end of the step and the momentum of every body along its free motions have one solution, which
/// takes no sweep while the bodies have few freedoms, however many rows push them.
TEST(SolvePenalty, SolvesForBodiesOfAnyFreedomInAnyOrder) {
  constexpr std::array kKinds{JointKind::kFixed, JointKind::kHinge, JointKind::kSlider, JointKind::kBall,
                              JointKind::kFree};
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    Random random(seed);
    Case c;
    const bool many_bodies = seed % 40 == 0;
    const std::size_t number = many_bodies ? 4 * kKinds.size() : kKinds.size();
    for (std::size_t b = 0; b < number; ++b) {
      c.bodies.push_back(random_body(random, kKinds[(b + seed) % kKinds.size()]));
      c.V.push_back({random_vector(random, 0.3), random_vector(random, 3)});
    }
    c.rows.resize(many_bodies ? 150 : seed % 20 == 0 ? 1500 : 1 + seed % 19);
    for (ContactRow& row : c.rows) row = random_row(random, static_cast<int>(number));
    SolverResult result;
    const ContactProblem problem = c.solve(result, many_bodies ? 20000 : 0);
    ASSERT_TRUE(result.converged) << "seed " << seed;
    std::vector<Vec6> pushed(number, Vec6::Zero());
    for (const ContactRow& row : c.rows) {
      double opening = 0.0;
      for (const auto& [body, sign] : {std::pair(row.body_a, 1.0), std::pair(row.body_b, -1.0)}) {
        const std::size_t b = static_cast<std::size_t>(body);
        const Vec3 r = row.p_W - c.bodies[b].X_WB.p;
        Vec6 J;
        J << row.n_BA_W, r.cross(row.n_BA_W);
        if (c.bodies[b].moves()) opening += sign * J.dot(c.displacement(problem, b));
        pushed[b] += sign * row.impulse / kStep * J;
      }
      const double law = row.stiffness * (row.margin - row.distance - opening);
      EXPECT_NEAR(row.impulse / kStep, std::max(0.0, law), 1e-3) << "seed " << seed;
    }
    for (std::size_t b = 0; b < number; ++b) {
      const Body& body = c.bodies[b];
      if (!body.moves()) continue;
      const Vec6 off = c.displacement(problem, b) - to_vector(c.V[b] * kStep);
      const Vec6 unbalanced = inertial_resistance(body, body.X_WB) * off / (kStep * kStep) - pushed[b];
      Eigen::Matrix<double, 6, Eigen::Dynamic> S = Mat6::Identity();
      if (body.joint.kind != JointKind::kFree) S = joint_motions(body.joint, body.X_WB);
      EXPECT_LT((S.transpose() * unbalanced).norm(), 1e-6) << "seed " << seed << " body " << b;
    }
  }
}

/// A slider that a coupling pulls and its spring, damper, dry friction and limits hold: all at once.
TEST(SolvePenalty, AJointActsOnWhatACouplingPulls) {
  const double k = 600.0;
  const auto rests_at = [&](const Joint& law, double pulled_to, int steps = 400) {
    Case c;
    c.bodies.emplace_back();
    Body& body = c.bodies[0];
    body.joint = law;
    body.joint.kind = JointKind::kSlider;
    body.joint.axis_W = Vec3::UnitX();
    Pose X_WB;
    double force = 0.0;
    for (int i = 0; i < steps; ++i) {
      ContactProblem problem(1, 1);
      Vec6 target = Vec6::Zero();
      target[0] = pulled_to - X_WB.p.x();
      problem.add_body({0, body, X_WB, {joint_position(body, X_WB), joint_position(body, X_WB)}}, X_WB.p,
                       {.linear = k, .angular = Mat3::Identity()}, target, kStep);
      problem.add_joint_rows(false);
      EXPECT_TRUE(PenaltySolver(8).solve({}, 100, problem).converged);
      X_WB.p.x() += problem.displacement(0)[0];
      force = k * (pulled_to - X_WB.p.x());
    }
    return std::pair(X_WB.p.x(), force);
  };
  const auto spring = rests_at({.stiffness = 300.0}, 0.01);
  EXPECT_NEAR(spring.first, 0.01 * 600.0 / 900.0, 1e-12);
  EXPECT_NEAR(spring.second, 2.0, 1e-9);
  const auto with_rest = rests_at({.stiffness = 300.0, .rest = -0.004}, 0.01);
  EXPECT_NEAR(with_rest.first, (600.0 * 0.01 - 300.0 * 0.004) / 900.0, 1e-12);
  const auto friction = rests_at({.friction = 1.5}, 0.01);
  EXPECT_NEAR(friction.second, 1.5, 1e-6);
  const auto stuck = rests_at({.friction = 6.5}, 0.01);
  EXPECT_NEAR(stuck.first, 0.0, 1e-8);
  const auto limit = rests_at({.upper = 0.004}, 0.01);
  EXPECT_NEAR(limit.first, 0.004, 1e-8);
  const auto lower = rests_at({.lower = -0.003}, -0.01);
  EXPECT_NEAR(lower.first, -0.003, 1e-8);
  // One step against a damper: k (10 mm - x) = d x / h.
  const auto damped = rests_at({.damping = 20.0}, 0.01, 1);
  EXPECT_NEAR(damped.first, 0.01 * k / (k + 20.0 / kStep), 1e-12);
}

TEST(SolvePenalty, AVeryStiffContactDoesNotShake) {
  // Explicit springs blow up when k h^2 / m > 4; here it is a million.
  Random random(1);
  Case c;
  c.bodies = {random_body(random, JointKind::kFixed), random_body(random, JointKind::kFree)};
  c.V = {Twist{}, Twist{Vec3(0, 0, -1), Vec3::Zero()}};
  ContactRow row;
  row.body_a = 1;
  row.body_b = 0;
  row.n_BA_W = Vec3::UnitZ();
  row.p_W = c.bodies[1].X_WB.p;
  row.distance = 1e-4;
  row.stiffness = 3e11;
  c.rows.push_back(row);
  SolverResult result;
  const ContactProblem problem = c.solve(result);
  EXPECT_NEAR(c.rows[0].distance + problem.displacement(1)[2], 0.0, 1e-8);
}

TEST(Step, AContactClosesAfterItsDistanceOverItsSpeed) {
  const std::vector<Pose> X(2);
  std::vector<Twist> V(2);
  V[1] = {Vec3(0, 0, -0.5), Vec3::Zero()};
  ContactRow row;
  row.body_a = 1;
  row.body_b = 0;
  row.n_BA_W = Vec3::UnitZ();
  row.distance = 1e-4;
  EXPECT_DOUBLE_EQ(time_of_closing(row, X, V, 0.001), 1e-4 / 0.5);
  EXPECT_EQ(time_of_closing(row, X, V, 1e-4), 1e-4);
  V[1].v.z() = 0.5;
  EXPECT_EQ(time_of_closing(row, X, V, 0.001), 0.001);
  row.distance = -1e-5;
  EXPECT_EQ(time_of_closing(row, X, V, 0.001), 0.0);
}

}  // namespace
}  // namespace tactum::solve_penalty_test
