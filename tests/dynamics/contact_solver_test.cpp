#include "tactum/dynamics/contact_solver.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <utility>

#include "tactum/base/random.h"
#include "tactum/dynamics/step.h"
#include "tactum/math/screw.h"

namespace tactum {
namespace {

Vec3 random_vector(Random& random, double size) {
  const double x = random.uniform(-size, size);
  const double y = random.uniform(-size, size);
  const double z = random.uniform(-size, size);
  return {x, y, z};
}

/// Two bodies, the first one fixed, with random contacts.
struct Problem {
  std::vector<Pose> X{2};
  std::vector<Mobility> W{2, Mobility::Zero()};
  std::vector<Twist> V{2};
  std::vector<ContactRow> rows;
  std::vector<PushRow> pushes;
  double h = 0.001;

  explicit Problem(std::uint64_t seed, int contacts) {
    pushes.reserve(static_cast<std::size_t>(contacts) + 1);
    Random random(seed);
    X[1].p = random_vector(random, 0.02);
    const Mat3 R = exp_rotation(random_vector(random, 2));
    W[1].topLeftCorner<3, 3>() = Mat3::Identity() / 0.3;
    W[1].bottomRightCorner<3, 3>() = R * Vec3(2e4, 1e4, 3e4).asDiagonal() * R.transpose();
    V[1] = {random_vector(random, 0.3), random_vector(random, 3)};
    for (int i = 0; i < contacts; ++i) {
      ContactRow row;
      row.body_a = 1;
      row.body_b = 0;
      row.n_BA_W = random_vector(random, 1).normalized();
      row.p_W = X[1].p + random_vector(random, 0.03);
      row.distance = random.uniform(-1e-4, 4e-4);
      row.tolerance = 3e-4;
      row.stiffness = random.uniform(100, 5000);
      rows.push_back(row);
    }
  }
};

TEST(ContactSolver, SolvesTheComplementarityProblem) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    // Few rows are solved by pivoting, more than 48 by sweeps.
    Problem p(seed, seed % 40 == 0 ? 60 : 1 + static_cast<int>(seed % 17));
    const std::vector<Twist> before = p.V;
    const SolverResult result = solve_contacts(p.rows, p.X, p.W, p.h, 20000, p.pushes, p.V);
    ASSERT_TRUE(result.converged) << "seed " << seed;
    Vec6 impulse = Vec6::Zero();
    for (const ContactRow& row : p.rows) {
      const Vec3 r = row.p_W - p.X[1].p;
      const double vn = row.n_BA_W.dot(velocity_at(p.V[1], r));
      const double end = row.distance + p.h * vn;
      const double force = row.impulse / p.h;
      // The published law at the end of the step, or no force where the pair is out of reach.
      EXPECT_NEAR(force, std::max(0.0, row.stiffness * (row.tolerance - end)), 1e-3) << "seed " << seed;
      Vec6 J;
      J << row.n_BA_W, r.cross(row.n_BA_W);
      impulse += J * row.impulse;
    }
    EXPECT_LT((to_vector(p.V[1]) - to_vector(before[1]) - p.W[1] * impulse).norm(), 1e-9);  // momentum
    EXPECT_EQ(p.V[0].v.norm() + p.V[0].w.norm(), 0.0);
  }
}

/// Bodies that are free, turn on a hinge, about a point, or not at all, named in any order. The law at the
/// end of the step and the momentum of every body have one solution.
TEST(ContactSolver, SolvesForBodiesOfAnyFreedomInAnyOrder) {
  constexpr std::size_t kBodies = 5;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    Random random(seed);
    std::vector<Pose> X(kBodies);
    std::vector<Mobility> W(kBodies, Mobility::Zero());
    std::vector<Twist> V(kBodies);
    for (std::size_t b = 0; b < kBodies; ++b) {
      X[b].p = random_vector(random, 0.02);
      const int freedom = std::array{0, 1, 1, 3, 6}[(b + seed) % kBodies];
      for (int k = 0; k < freedom; ++k) {  // light enough for the contacts, about the centre and beside it
        Vec6 s;
        s << random_vector(random, 1.5), random_vector(random, 100.0);
        W[b] += s * s.transpose();
      }
      V[b] = to_twist(W[b] * Vec6::Constant(0.01 * random.uniform(-1, 1)));
    }
    std::vector<ContactRow> rows(1 + seed % 19);
    for (ContactRow& row : rows) {
      row.body_a = static_cast<int>(random.uniform(0, kBodies));
      row.body_b = (row.body_a + 1 + static_cast<int>(random.uniform(0, kBodies - 1))) % int(kBodies);
      row.n_BA_W = random_vector(random, 1).normalized();
      row.p_W = random_vector(random, 0.03);
      row.distance = random.uniform(-1e-4, 4e-4);
      row.tolerance = 3e-4;
      row.stiffness = random.uniform(100, 5000);
    }
    std::vector<PushRow> pushes;
    pushes.reserve(rows.size());
    const std::vector<Twist> before = V;
    const double h = 0.001;
    ASSERT_TRUE(solve_contacts(rows, X, W, h, 20000, pushes, V).converged) << "seed " << seed;
    std::vector<Vec6> impulse(kBodies, Vec6::Zero());
    for (const ContactRow& row : rows) {
      double vn = 0.0;
      for (const auto& [body, sign] : {std::pair(row.body_a, 1.0), std::pair(row.body_b, -1.0)}) {
        const std::size_t b = static_cast<std::size_t>(body);
        const Vec3 r = row.p_W - X[b].p;
        vn += sign * row.n_BA_W.dot(velocity_at(V[b], r));
        Vec6 J;
        J << row.n_BA_W, r.cross(row.n_BA_W);
        impulse[b] += sign * row.impulse * J;
      }
      const double pushed = row.stiffness * (row.tolerance - row.distance - h * vn);
      EXPECT_NEAR(row.impulse / h, std::max(0.0, pushed), 1e-3) << "seed " << seed;
    }
    for (std::size_t b = 0; b < kBodies; ++b)
      EXPECT_LT((to_vector(V[b]) - to_vector(before[b]) - W[b] * impulse[b]).norm(), 1e-8) << "seed " << seed;
  }
}

TEST(ContactSolver, ActionEqualsReaction) {
  Random random(7);
  Problem p(3, 5);
  p.W[0] = 0.5 * Mobility::Identity();
  p.V[0] = {random_vector(random, 0.1), Vec3::Zero()};
  const std::vector<Twist> before = p.V;
  solve_contacts(p.rows, p.X, p.W, p.h, 500, p.pushes, p.V);
  Wrench total;
  for (int body : {0, 1}) {
    Vec6 M_dV = p.W[std::size_t(body)].inverse() *
                (to_vector(p.V[std::size_t(body)]) - to_vector(before[std::size_t(body)]));
    const Wrench impulse{M_dV.head<3>(), M_dV.tail<3>()};
    total = total + moved(impulse, Vec3::Zero() - p.X[std::size_t(body)].p);
  }
  EXPECT_LT(total.f.norm(), 1e-12);
  EXPECT_LT(total.t.norm(), 1e-12);
}

TEST(ContactSolver, AVeryStiffContactDoesNotShake) {
  // Explicit springs blow up when k h^2 / m > 4; here it is a million.
  Problem p(1, 0);
  ContactRow row;
  row.body_a = 1;
  row.body_b = 0;
  row.n_BA_W = Vec3::UnitZ();
  row.p_W = p.X[1].p;
  row.distance = 1e-4;
  row.stiffness = 3e11;
  p.V[1] = {Vec3(0, 0, -1), Vec3::Zero()};
  p.rows.push_back(row);
  solve_contacts(p.rows, p.X, p.W, p.h, 100, p.pushes, p.V);
  EXPECT_NEAR(p.rows[0].distance + p.h * p.V[1].v.z(), 0.0, 1e-9);
}

TEST(Step, AContactClosesAfterItsDistanceOverItsSpeed) {
  Problem p(1, 0);
  p.V[1] = {Vec3(0, 0, -0.5), Vec3::Zero()};
  ContactRow row;
  row.body_a = 1;
  row.body_b = 0;
  row.n_BA_W = Vec3::UnitZ();
  row.p_W = p.X[1].p;
  row.distance = 1e-4;
  EXPECT_DOUBLE_EQ(time_of_closing(row, p.X, p.V, 0.001), 1e-4 / 0.5);
  EXPECT_EQ(time_of_closing(row, p.X, p.V, 1e-4), 1e-4);
  p.V[1].v.z() = 0.5;
  EXPECT_EQ(time_of_closing(row, p.X, p.V, 0.001), 0.001);
  row.distance = -1e-5;
  EXPECT_EQ(time_of_closing(row, p.X, p.V, 0.001), 0.0);
}

TEST(HingeFriction, HoldsBelowItsLimitAndSlowsAboveIt) {
  const Joint joint{.kind = JointKind::kHinge,
                    .axis_W = Vec3::UnitZ(),
                    .anchor_W = Vec3::Zero(),
                    .damping = 0.0,
                    .friction = 0.01};
  Body body;
  body.joint = joint;
  body.mass_kg = 0.2;
  body.inertia_B = 1e-4 * Mat3::Identity();
  const Mobility W = mobility(joint, body.X_WB, inertial_resistance(body, body.X_WB));
  const auto rate_after = [&](double rate) {
    Twist V;
    V.w.z() = rate;
    return after_joint(body, body.X_WB, W, 0.001, V).w.z();
  };
  EXPECT_EQ(rate_after(0.05), 0.0);  // the friction takes 0.01 * 0.001 / 1e-4 = 0.1 rad/s a step
  EXPECT_NEAR(rate_after(-0.5), -0.4, 1e-12);
}

}  // namespace
}  // namespace tactum
