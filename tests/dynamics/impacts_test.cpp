#include "tactum/dynamics/impacts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "random_bodies.h"

namespace tactum::impacts_test {
namespace {

using test::random_body;
using test::random_vector;

constexpr double kStep_s = 0.001;

struct Motion {
  double energy_J = 0.0;
  Vec3 momentum = Vec3::Zero(), spin = Vec3::Zero();
};

Motion motion_of(const World& world, const std::vector<Pose>& X_WB, const std::vector<Twist>& V) {
  Motion sum;
  for (std::size_t i = 0; i < V.size(); ++i) {
    const Body& body = world.bodies[i];
    const Mat3 I = X_WB[i].R * body.inertia_B * X_WB[i].R.transpose();
    sum.energy_J += 0.5 * body.mass_kg * V[i].v.squaredNorm() + 0.5 * V[i].w.dot(I * V[i].w);
    sum.momentum += body.mass_kg * V[i].v;
    sum.spin += I * V[i].w + X_WB[i].p.cross(body.mass_kg * V[i].v);
  }
  return sum;
}

/// Two free bodies that meet at one point, or at the corners of a face.
struct TwoBodies {
  World world;
  std::vector<Pose> X_WB;
  std::vector<Twist> V, detour = std::vector<Twist>(2);
  std::vector<ContactRow> rows;

  TwoBodies(std::uint64_t seed, int corners, double restitution, double friction, double size, double speed) {
    Random random(seed);
    const Vec3 n = random_vector(random, 1).normalized();
    const Vec3 u = any_orthogonal(n);
    const Vec3 v = n.cross(u);
    for (const double side : {1.0, -1.0}) {
      Body body = random_body(random, JointKind::kFree);
      body.inertia_B *= size * size / 1e-4;
      body.X_WB.p = side * size * n + random_vector(random, 0.3 * size);
      X_WB.push_back(body.X_WB);
      V.push_back({-side * speed * n + random_vector(random, 0.5 * speed),
                   random_vector(random, 0.2 * speed / size)});
      world.bodies.push_back(body);
    }
    for (int i = 0; i < corners; ++i) {
      const double angle = 2.0 * kPi * i / corners;
      ContactRow row;
      row.body_a = 0;
      row.body_b = 1;
      row.n_BA_W = n;
      row.p_W =
          corners == 1 ? Vec3(Vec3::Zero()) : Vec3(0.4 * size * (std::cos(angle) * u + std::sin(angle) * v));
      row.friction = friction;
      row.impact.restitution = restitution;
      rows.push_back(row);
    }
  }
  double normal_velocity(const ContactRow& row) const {
    return row.n_BA_W.dot(velocity_at(V[0], row.p_W - X_WB[0].p) - velocity_at(V[1], row.p_W - X_WB[1].p));
  }
  ImpactResult resolve(int most = 8) {
    ImpactScratch scratch(2);
    const std::vector<char> moves{1, 1};
    const std::vector<Twist> A(2);
    return resolve_impacts(rows, {world, X_WB, moves, A, A, V, detour}, kStep_s, most, scratch, nullptr);
  }
};

constexpr double kSizes[] = {0.002, 0.02, 2.0};
constexpr double kSpeeds[] = {0.2, 2.0, 50.0};

/// Of one point without friction all the energy stays that is not in the approach, and of that e^2.
TEST(Impacts, OnePointKeepsEnergyByTheSquareOfTheRestitution) {
  for (const double size : kSizes)
    for (const double speed : kSpeeds)
      for (const double e : {0.0, 0.3, 0.7, 1.0})
        for (std::uint64_t seed = 1; seed <= 40; ++seed) {
          TwoBodies plastic(seed, 1, 0.0, 0.0, size, speed);
          TwoBodies m(seed, 1, e, 0.0, size, speed);
          const double approach = -m.normal_velocity(m.rows[0]);
          if (!(approach > 0.05 * speed)) continue;
          const Motion before = motion_of(m.world, m.X_WB, m.V);
          ASSERT_TRUE(plastic.resolve().converged);
          ASSERT_TRUE(m.resolve().converged);
          EXPECT_NEAR(m.normal_velocity(m.rows[0]), e * approach, 1e-10 * approach);
          const Motion after = motion_of(m.world, m.X_WB, m.V);
          const double lost = before.energy_J - motion_of(plastic.world, plastic.X_WB, plastic.V).energy_J;
          EXPECT_NEAR(before.energy_J - after.energy_J, (1.0 - e * e) * lost, 1e-9 * before.energy_J);
          EXPECT_LT((after.momentum - before.momentum).norm(),
                    1e-12 * before.momentum.norm() + 1e-12 * speed);
          EXPECT_LT((after.spin - before.spin).norm(), 1e-11 * (before.spin.norm() + size * speed));
        }
}

/// However many corners meet, in whatever order: none approaches afterwards, no energy is made, the answer is
/// the same.
TEST(Impacts, TheOrderOfCornersMeansNothing) {
  for (const double size : kSizes)
    for (const int corners : {2, 3, 4, 7, 16})
      for (const double friction : {0.0, 0.4})
        for (std::uint64_t seed = 1; seed <= 20; ++seed) {
          TwoBodies m(seed, corners, 1.0, friction, size, 2.0);
          TwoBodies turned = m;
          std::rotate(turned.rows.begin(), turned.rows.begin() + corners / 2, turned.rows.end());
          std::swap(turned.rows.front(), turned.rows.back());
          const Motion before = motion_of(m.world, m.X_WB, m.V);
          ASSERT_TRUE(m.resolve().converged);
          ASSERT_TRUE(turned.resolve().converged);
          for (const ContactRow& row : m.rows) EXPECT_GT(m.normal_velocity(row), -1e-9);
          const Motion after = motion_of(m.world, m.X_WB, m.V);
          EXPECT_LT(after.energy_J, before.energy_J * (1.0 + 1e-9));
          EXPECT_LT((after.momentum - before.momentum).norm(), 1e-10);
          for (int i = 0; i < 2; ++i) {
            EXPECT_LT((m.V[i].v - turned.V[i].v).norm(), friction > 0.0 ? 1e-6 : 1e-9) << seed;
            EXPECT_LT((m.V[i].w - turned.V[i].w).norm() * size, friction > 0.0 ? 1e-6 : 1e-9) << seed;
          }
        }
}

/// A ball that hits a wall obliquely: Coulomb's law decides between sliding and rolling.
TEST(Impacts, ABallOnAWallSlidesOrRolls) {
  for (const double mu : {0.05, 0.1, 0.2, 0.5, 1.0})
    for (const double radius : {0.001, 0.01, 1.0}) {
      World world;
      Body ball;
      ball.mass_kg = 0.1;
      ball.inertia_B = 0.4 * 0.1 * radius * radius * Mat3::Identity();
      world.bodies = {ball, Body{}};
      world.bodies[1].joint.kind = JointKind::kFixed;
      const std::vector<Pose> X_WB(2);
      std::vector<Twist> V(2);
      V[0].v = Vec3(1.0, 0.0, -0.8);
      ContactRow row;
      row.body_a = 0;
      row.body_b = 1;
      row.n_BA_W = Vec3::UnitZ();
      row.p_W = Vec3(0, 0, -radius);
      row.friction = mu;
      row.impact.restitution = 0.5;
      ImpactScratch scratch(2);
      const std::vector<char> moves{1, 0};
      std::vector<ContactRow> rows{row};
      const std::vector<Twist> A(2);
      std::vector<Twist> detour(2);
      EXPECT_TRUE(resolve_impacts(rows, {world, X_WB, moves, A, A, V, detour}, kStep_s, 8, scratch, nullptr)
                      .converged);
      const double normal = 0.1 * 0.8 * 1.5;
      const double to_roll = 0.1 * 1.0 * 2.0 / 7.0;
      const double across = std::min(mu * normal, to_roll);
      EXPECT_NEAR(V[0].v.z(), 0.4, 1e-9);
      EXPECT_NEAR(V[0].v.x(), 1.0 - across / 0.1, 2e-6) << mu << " " << radius;
      EXPECT_NEAR(V[0].w.y() * radius, across / (0.4 * 0.1), 5e-6) << mu << " " << radius;
    }
}

/// Two bodies that meet within the step: each is led to where it is hit and on from there, momentum and spin
/// about any point are kept, and what lies behind is hit later.
TEST(Impacts, EachHasItsTime) {
  for (const double size : kSizes)
    for (const double speed : kSpeeds)
      for (const double fraction : {0.1, 0.5, 0.95})  // of the step, to the impact
        for (std::uint64_t seed = 1; seed <= 20; ++seed) {
          TwoBodies m(seed, 1, 1.0, 0.0, size, speed);
          const double closing = -m.normal_velocity(m.rows[0]);
          if (!(closing > 0.05 * speed) || speed * kStep_s > 0.1 * size) continue;
          m.rows[0].distance = fraction * kStep_s * closing;
          const std::vector<Pose> X_start = m.X_WB;
          const std::vector<Twist> V_start = m.V;
          const Motion before = motion_of(m.world, m.X_WB, m.V);
          ASSERT_TRUE(m.resolve().converged);
          for (std::size_t i = 0; i < 2; ++i) {
            const Vec3 end = X_start[i].p + kStep_s * (fraction * V_start[i].v + (1.0 - fraction) * m.V[i].v);
            m.X_WB[i].p = X_start[i].p + m.V[i].v * kStep_s + m.detour[i].v;
            EXPECT_LT((m.X_WB[i].p - end).norm(), 1e-11 * speed * kStep_s);
          }
          const Motion after = motion_of(m.world, m.X_WB, m.V);
          EXPECT_NEAR(after.energy_J, before.energy_J, 1e-9 * before.energy_J);
          EXPECT_LT((after.momentum - before.momentum).norm(), 1e-12 * (before.momentum.norm() + speed));
          EXPECT_LT((after.spin - before.spin).norm(), 1e-11 * (before.spin.norm() + size * speed));
        }
}

}  // namespace
}  // namespace tactum::impacts_test
