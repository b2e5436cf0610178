/// Bodies that move by themselves, against mechanics in closed form.

#include "tactum/response/free_bodies.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/effort.h"
#include "support/sandbox.h"
#include "tactum/math/screw.h"

namespace tactum::free_bodies_test {
namespace {

const Vec3 kGravity(0, 0, -9.81);  // [m/s^2]

Pose at(double x, double y, double z, const Vec3& turn = Vec3::Zero()) {
  return {exp_rotation(turn), {x, y, z}};
}
Polytope cube(double half) { return make_box({half, half, half}); }

TEST(FreeBodies, FallOnTheParabola) {
  Sandbox box;
  box.world.gravity_W = kGravity;
  const int b = box.add(cube(0.01), at(0, 0, 0), {{0.3, 0.0, 2.0}, {3.0, -2.0, 5.0}});
  box.run(1.0);
  EXPECT_LT((box.X(b).p - Vec3(0.3, 0.0, 2.0 - 0.5 * 9.81)).norm(), 1e-12);
  EXPECT_LT((box.V(b).v - Vec3(0.3, 0.0, 2.0 - 9.81)).norm(), 1e-12);
}

/// How far the axis of a free top is from Euler's solution after two seconds, as a fraction of its tilt.
double lag_of_top(double dt_s) {
  Sandbox box;
  box.settings.dt_s = dt_s;
  const int b = box.add(make_prism(24, 0.02, 0.008), at(0, 0, 0), {Vec3::Zero(), {1.5, 0.0, 60.0}});
  const Vec3 L = box.angular_momentum();
  const double energy = box.energy();
  const double turned = L.norm() / box.world.bodies[0].inertia_B(0, 0) * 2.0;  // the axis about L [rad]
  box.run(2.0);
  EXPECT_LT((box.angular_momentum() - L).norm(), 1e-12 * L.norm());
  EXPECT_NEAR(box.energy(), energy, 1e-6 * energy);
  const Vec3 axis = exp_rotation(L.normalized() * turned) * Vec3::UnitZ();
  return (box.X(b).R.col(2) - axis).norm() / std::acos(L.normalized().z());
}

TEST(FreeBodies, AFreeTopKeepsItsMomentumAndPrecessesAsEulerSays) {
  const double coarse = lag_of_top(1e-3);
  EXPECT_LT(coarse, 0.1);  // of 228 rad
  EXPECT_NEAR(coarse / lag_of_top(0.5e-3), 4.0, 0.3);
}

/// A top on its tip under gravity: slow precession at m g l / (I3 w), nutation left aside.
TEST(FreeBodies, AHeavyTopPrecesses) {
  Sandbox box;
  box.world.gravity_W = kGravity;
  const double lever = 0.03;  // from the tip to the centre of mass [m]
  const Vec3 tip = Vec3::Zero();
  const Vec3 axis(1, 0, 0);
  const double spin = 400.0;
  const Polytope disc = make_prism(24, 0.02, 0.006);
  const int b = box.add(disc, {exp_rotation({0, kPi / 2, 0}), axis * lever}, {Vec3::Zero(), axis * spin},
                        {.kind = JointKind::kBall, .anchor_W = tip});
  const Body& body = box.world.bodies[0];
  const double slow = body.mass_kg * 9.81 * lever / (body.inertia_B(2, 2) * spin);  // [rad/s]
  // Started with the precession's rate, there is no nutation to the first order.
  box.world.bodies[0].V_WB.w += Vec3(0, 0, slow);
  box.world.bodies[0].V_WB.v = Vec3(0, 0, slow).cross(axis * lever);
  box.run(1.0);
  const Vec3 now = box.X(b).p / lever;
  EXPECT_NEAR(now.norm(), 1.0, 1e-9);
  EXPECT_NEAR(std::remainder(std::atan2(now.y(), now.x()) - slow, 2.0 * kPi), 0.0, 0.02 * slow);
  EXPECT_NEAR(now.z(), 0.0, 0.02);
}

TEST(FreeBodies, ImpactsKeepMomentumAndLoseWhatRestitutionSays) {
  for (const double e : {0.0, 0.4, 1.0}) {
    Sandbox box;
    const int a = box.add(cube(0.01), at(-0.05, 0, 0), {{1.0, 0, 0}, Vec3::Zero()});
    const int b = box.add(cube(0.02), at(0.05, 0, 0), {{-0.5, 0, 0}, Vec3::Zero()});
    box.bounce(e);
    const double m_a = box.world.bodies[0].mass_kg;
    const double m_b = box.world.bodies[1].mass_kg;
    const Vec3 momentum = box.momentum();
    box.run(0.1);
    const double common = (m_a * 1.0 - m_b * 0.5) / (m_a + m_b);
    EXPECT_NEAR(box.V(a).v.x(), common - e * 1.5 * m_b / (m_a + m_b), 1e-9) << "e = " << e;
    EXPECT_NEAR(box.V(b).v.x(), common + e * 1.5 * m_a / (m_a + m_b), 1e-9);
    EXPECT_LT((box.momentum() - momentum).norm(), 1e-12);
    EXPECT_EQ(box.penetrating_frames, 0);
  }
}

TEST(FreeBodies, ASkewImpactKeepsMomentumBothWays) {
  Sandbox box;
  box.add(make_box({0.01, 0.02, 0.015}), at(-0.06, 0.006, 0.003, {0.3, 0.5, -0.2}),
          {{2.0, 0.1, 0}, {1, 2, 3}});
  box.add(make_ellipsoid(2, {0.03, 0.02, 0.01}), at(0.03, 0, 0, {0.1, -0.4, 0.9}),
          {{-1.0, 0, 0.1}, {0, -4, 2}});
  box.bounce(0.7);
  box.rub(0.3);
  const Vec3 p = box.momentum();
  const Vec3 L = box.angular_momentum();
  const double energy = box.energy();
  int hits = 0;
  for (int i = 0; i < 200; ++i) {
    box.step();
    hits += box.report.impacts;
  }
  EXPECT_GT(hits, 0);
  EXPECT_LT((box.momentum() - p).norm(), 1e-9 * p.norm());
  // The two points of the impact are apart by the gap at which it occurs.
  EXPECT_LT((box.angular_momentum() - L).norm(), 1e-9 * L.norm());
  EXPECT_LT(box.energy(), energy);
  EXPECT_EQ(box.penetrating_frames, 0);
}

TEST(FreeBodies, TheBooksOfMomentumBalance) {
  Sandbox box;
  box.world.gravity_W = kGravity;
  box.add_fixed(make_box({0.1, 0.1, 0.01}), at(0, 0, -0.01));
  box.add(cube(0.01), at(0, 0, 0.03, {0.3, 0.2, 0.1}), {{0.2, 0, 0}, {4, 0, 2}});
  box.add(make_ellipsoid(2, {0.02, 0.015, 0.01}), at(0.005, 0, 0.07), {{0, 0, -1.0}, Vec3::Zero()});
  box.add(cube(0.015), at(-0.04, 0, 0.016));
  box.bounce(0.5);
  box.rub(0.4);
  double off = 0.0;
  int hits = 0;
  for (int i = 0; i < 1500; ++i) {
    box.step();
    hits += box.report.impacts;
    if (!box.report.forced_short) off = std::max(off, box.report.momentum_off_Ns);
  }
  EXPECT_GT(hits, 5);
  EXPECT_GT(off, 0.0);  // a few roundings
  EXPECT_LT(off, 1e-14);
}

TEST(FreeBodies, ABallWithoutLossBouncesToItsHeight) {
  Sandbox box;
  box.world.gravity_W = kGravity;
  box.add_fixed(make_box({0.1, 0.1, 0.01}), at(0, 0, -0.01));
  const int b = box.add(cube(0.01), at(0, 0, 0.06));
  box.bounce(1.0);
  const double energy = box.energy();
  double highest = 0.0;
  int hits = 0;
  for (int i = 0; i < 3000; ++i) {
    box.step();
    hits += box.report.impacts;
    if (i > 2500) highest = std::max(highest, box.X(b).p.z());
  }
  EXPECT_GT(hits, 10);
  EXPECT_NEAR(box.energy(), energy, 1e-8 * energy);
  EXPECT_NEAR(highest, 0.06, 1e-4);
  EXPECT_EQ(box.penetrating_frames, 0);
}

/// On a plate tilted by turning gravity.
double slid_after(double tilt, double mu, double seconds) {
  Sandbox box;
  box.world.gravity_W = 9.81 * Vec3(std::sin(tilt), 0, -std::cos(tilt));
  box.add_fixed(make_box({2.0, 0.1, 0.01}), at(0, 0, -0.01));
  const int b = box.add(make_box({0.02, 0.015, 0.01}), at(0, 0, 0.01001));
  box.rub(mu);
  box.run(0.1);  // it settles onto its skin
  const double start = box.X(b).p.x();
  // The state's velocity is that of half a frame ago.
  const double speed = box.begun().world.V_WB[1].v.x();
  box.run(seconds);
  EXPECT_EQ(box.penetrating_frames, 0);
  const double ahead = 1.0 + box.settings.dt_s / seconds;
  return (box.X(b).p.x() - start - speed * seconds) / ahead;
}

TEST(FreeBodies, ABlockHoldsOnAnInclineBelowTheAngleOfFrictionAndSlidesAboveIt) {
  const double mu = 0.3;
  const double angle = std::atan(mu);
  EXPECT_NEAR(slid_after(angle - 0.002, mu, 2.0), 0.0, 1e-9);
  for (const double tilt : {angle + 0.002, angle + 0.2}) {
    const double expected = 0.5 * 9.81 * (std::sin(tilt) - mu * std::cos(tilt));
    EXPECT_NEAR(slid_after(tilt, mu, 1.0), expected, 1e-3 * expected);
  }
}

TEST(FreeBodies, TenBoxesStayStacked) {
  const double seconds = testing::full_run() ? 60.0 : 6.0;
  Sandbox box;
  box.world.gravity_W = kGravity;
  box.add_fixed(make_box({0.1, 0.1, 0.01}), at(0, 0, -0.01));
  std::vector<int> stack;
  for (int i = 0; i < 10; ++i)
    stack.push_back(box.add(make_box({0.02, 0.02, 0.01}),
                            at(1e-3 * (i % 3), -1e-3 * (i % 2), 0.01 + i * 0.02001, {0, 0, 0.05 * i})));
  box.rub(0.4);
  box.run(1.0);
  std::vector<Vec3> before;
  for (const int b : stack) before.push_back(box.X(b).p);
  box.run(seconds);
  double drift = 0.0;
  for (std::size_t i = 0; i < stack.size(); ++i)
    drift = std::max(drift, (box.X(stack[i]).p - before[i]).norm());
  RecordProperty("drift_um", std::to_string(1e6 * drift));
  EXPECT_LT(drift, 10e-6 * seconds / 60.0);
  EXPECT_EQ(box.penetrating_frames, 0);
}

TEST(FreeBodies, NewtonsCradleHandsTheBlowOn) {
  Sandbox box;
  box.world.gravity_W = kGravity;
  const double length = 0.1;
  const double half = 0.01;
  std::vector<int> balls;
  for (int i = 0; i < 5; ++i) {
    const double x = i * (2 * half + 1e-6);
    const Joint hinge{.kind = JointKind::kHinge, .axis_W = Vec3::UnitY(), .anchor_W = {x, 0, length}};
    Pose X = at(x, 0, 0);
    if (i == 0) {
      const Mat3 swung = exp_rotation({0, 0.3, 0});
      X = {swung, Vec3(0, 0, length) + swung * Vec3(0, 0, -length)};
    }
    balls.push_back(box.add(cube(half), X, {}, hinge));
  }
  box.bounce(1.0);
  double first = 0.0, last = 0.0, middle = 0.0;
  // A swing and a half: the first comes down, the last goes up and comes back.
  for (int i = 0; i < 480; ++i) {
    box.step();
    const auto swing = [&](int b) {
      return std::atan2(box.X(balls[std::size_t(b)]).p.x() - b * (2 * half + 1e-6), 0.1);
    };
    last = std::max(last, swing(4));
    if (box.simulation->next_index() > 170 && box.simulation->next_index() < 420)
      first = std::max(first, std::abs(swing(0)));
    for (int b = 1; b < 4; ++b) middle = std::max(middle, std::abs(swing(b)));
  }
  EXPECT_NEAR(last, std::atan2(length * std::sin(0.3), 0.1), 0.01);
  EXPECT_LT(middle, 0.01);
  EXPECT_LT(first, 0.01);
  EXPECT_EQ(box.penetrating_frames, 0);
}

TEST(FreeBodies, HingesAndSlidersHoldToRounding) {
  Sandbox box;
  box.world.gravity_W = kGravity;
  const Vec3 anchor(0.02, 0.01, 0.03);
  const Vec3 axis = Vec3(1, 2, 0.5).normalized();
  const int hinged =
      box.add(cube(0.01), at(0, 0, 0), {}, {.kind = JointKind::kHinge, .axis_W = axis, .anchor_W = anchor});
  const int sliding =
      box.add(cube(0.01), at(0.2, 0, 0), {}, {.kind = JointKind::kSlider, .axis_W = axis, .stiffness = 5.0});
  const int thrown = box.add(cube(0.008), at(0.005, 0, 0.1), {{0, 0, -1.0}, {2, 3, 4}});
  box.bounce(0.5);
  box.rub(0.2);
  const Vec3 p_hinge = anchor;  // in the body, whose frame is the world's at the start
  for (int i = 0; i < 2000; ++i) {
    box.step();
    const Pose& X = box.X(hinged);
    ASSERT_LT((X * p_hinge - anchor).norm(), 1e-12);
    ASSERT_LT((X.R * axis - axis).norm(), 1e-12);
    const Pose& S = box.X(sliding);
    ASSERT_LT(axis.cross(S.p - Vec3(0.2, 0, 0)).norm(), 1e-12);
    ASSERT_LT((S.R - Mat3::Identity()).norm(), 1e-12);
  }
  EXPECT_TRUE(box.X(thrown).finite());
  EXPECT_EQ(box.penetrating_frames, 0);
}

TEST(FreeBodies, APendulumTakesItsTime) {
  Sandbox box;
  box.world.gravity_W = kGravity;
  const double length = 0.25;
  const double swing = 0.1;
  const Mat3 swung = exp_rotation({0, swing, 0});
  const int b = box.add(cube(0.01), {swung, swung * Vec3(0, 0, -length)}, {},
                        {.kind = JointKind::kHinge, .axis_W = Vec3::UnitY(), .anchor_W = Vec3::Zero()});
  const Body& body = box.world.bodies[0];
  const double inertia = body.inertia_B(1, 1) + body.mass_kg * length * length;
  // The series of the elliptic integral: 1 + a^2 / 16 + 11 a^4 / 3072.
  const double period = 2 * kPi * std::sqrt(inertia / (body.mass_kg * 9.81 * length)) *
                        (1 + swing * swing / 16 + 11 * std::pow(swing, 4) / 3072);
  double last = box.X(b).p.x();
  double crossing = 0.0;
  int crossings = 0;
  for (int i = 1; i <= 10000; ++i) {
    box.step();
    const double x = box.X(b).p.x();
    if (last < 0.0 && x >= 0.0) {
      crossing = 1e-3 * (i - x / (x - last));
      ++crossings;
    }
    last = x;
  }
  // From the height on the other side (x < 0 at first) to the n-th upward crossing: n - 3/4 periods.
  EXPECT_NEAR(crossing / (crossings - 0.75), period, 1e-5 * period);
}

TEST(FreeBodies, LimitsSpringsAndFrictionOfJoints) {
  Sandbox box;
  box.world.gravity_W = kGravity;
  const Joint spring{.kind = JointKind::kSlider, .axis_W = Vec3::UnitZ(), .damping = 0.5, .stiffness = 20.0};
  const Joint stopped{.kind = JointKind::kSlider, .axis_W = Vec3::UnitZ(), .lower = -0.03};
  const Joint stiff{
      .kind = JointKind::kHinge, .axis_W = Vec3::UnitY(), .anchor_W = {0.57, 0, 0}, .friction = 0.01};
  const int sprung = box.add(cube(0.01), at(0, 0, 0), {}, spring);
  const int dropped = box.add(cube(0.01), at(0.3, 0, 0), {}, stopped);
  const int braked = box.add(cube(0.01), at(0.6, 0, 0), {}, stiff);  // 0.0024 N m of gravity
  box.run(5.0);
  const double weight = box.world.bodies[0].mass_kg * 9.81;
  EXPECT_NEAR(box.X(sprung).p.z(), -weight / 20.0, 1e-9);
  EXPECT_NEAR(box.X(dropped).p.z(), -0.03, 1e-9);
  EXPECT_NEAR(box.X(braked).p.z(), 0.0, 1e-12);
}

TEST(FreeBodies, FastAndSmallDoesNotPassThroughThin) {
  for (const double speed : {5.0, 30.0, 100.0}) {
    Sandbox box;
    box.add_fixed(make_box({0.1, 0.1, 0.0005}), at(0, 0, 0));
    const int b = box.add(cube(0.002), at(0, 0, 0.137), {{0, 0, -speed}, {30, 20, 10}});
    for (int i = 0; i < 100; ++i) {
      box.step();
      ASSERT_GT(box.X(b).p.z(), 0.0) << speed << " m/s, frame " << i;
    }
    EXPECT_EQ(box.penetrating_frames, 0);
  }
}

}  // namespace
}  // namespace tactum::free_bodies_test
