// Bodies that bounce, against closed forms: an impact is met at its own time within the frame, so a bounce is
// a pair of parabolas to rounding, whatever the size, the speed and the rate.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/effort.h"
#include "support/rotation_between.h"
#include "support/sandbox.h"
#include "tactum/base/tolerances.h"
#include "tactum/math/screw.h"

namespace tactum::bounce_test {
namespace {

constexpr double kGravity = 9.81;  // [m/s^2]

struct Drop {
  double size_m = 0.02;
  double height_m = 0.05;  // of the lowest point above the floor
  double restitution = 0.8;
  double rate_Hz = 1000.0;
  bool ball = false;  // an icosphere, not a cube
  bool floor_first = true;
};

std::ostream& operator<<(std::ostream& out, const Drop& drop) {
  return out << (drop.ball ? "ball" : "cube") << " of " << drop.size_m << " m from " << drop.height_m
             << " m, e " << drop.restitution << ", " << drop.rate_Hz << " Hz";
}

struct Dropped {
  Sandbox box;
  int body = -1;
  double rest_z_m = 0.0;  // of the body's origin when its gap is the skin
  double fall_m = 0.0;    // from the start to there
};

Dropped dropped(const Drop& drop) {
  Dropped made;
  made.box.world.gravity_W = {0, 0, -kGravity};
  made.box.settings.dt_s = 1.0 / drop.rate_Hz;
  const double half = 0.5 * drop.size_m;
  const Polytope shape = drop.ball ? make_icosphere(2, half) : make_box({half, half, half});
  double lowest = 0.0;
  for (const Vec3& p : shape.vertices) lowest = std::min(lowest, p.z());
  const auto add_floor = [&] {
    made.box.add_fixed(make_box(drop.size_m * Vec3(2, 2, 0.5)),
                       {Mat3::Identity(), {0, 0, -0.5 * drop.size_m}});
  };
  if (drop.floor_first) add_floor();
  made.body = made.box.add(shape, {Mat3::Identity(), {0, 0, drop.height_m - lowest}});
  if (!drop.floor_first) add_floor();
  const double skin =
      tolerances::kSkin * made.box.world.bodies[static_cast<std::size_t>(made.body)].part->size;
  made.rest_z_m = skin - lowest;
  made.fall_m = drop.height_m - skin;
  made.box.bounce(drop.restitution);
  return made;
}

/// Height above rest at time t of a ball that bounces.
double bounced_height(double fall_m, double e, double t) {
  double left_s = t - std::sqrt(2.0 * fall_m / kGravity);
  if (left_s < 0.0) return fall_m - 0.5 * kGravity * t * t;
  double up = e * std::sqrt(2.0 * kGravity * fall_m);
  for (; up > 0.0 && left_s > 2.0 * up / kGravity; up *= e) left_s -= 2.0 * up / kGravity;
  return left_s * (up - 0.5 * kGravity * left_s);
}

/// A bounce has the square of the restitution of the energy, and leads along its parabola, from its first
/// frame to its apex.
void expect_bounces(const Drop& drop, int bounces) {
  SCOPED_TRACE(::testing::Message() << drop);
  Dropped made = dropped(drop);
  const double dt_s = made.box.settings.dt_s;
  const double e = drop.restitution;
  const double mass_kg = made.box.world.bodies[static_cast<std::size_t>(made.body)].mass_kg;
  double impact_s = std::sqrt(2.0 * made.fall_m / kGravity);
  int frame = 0;
  for (int bounce = 1; bounce <= bounces; ++bounce) {
    const double share = std::pow(e, 2.0 * bounce);
    const double up_s = std::sqrt(2.0 * share * made.fall_m / kGravity);
    const int last = static_cast<int>((impact_s + up_s) / dt_s);
    for (; frame <= last; ++frame) {
      made.box.step();
      const double t = (frame + 1) * dt_s;
      ASSERT_NEAR(made.box.X(made.body).p.z() - made.rest_z_m, bounced_height(made.fall_m, e, t),
                  1e-6 * share * made.fall_m + 1e-12 * drop.size_m)
          << "at " << t << " s";
    }
    const double height_m = made.box.energy() / (mass_kg * kGravity) - made.rest_z_m;
    EXPECT_NEAR(height_m, share * made.fall_m, 1e-6 * share * made.fall_m);
    impact_s += 2.0 * up_s;
  }
  EXPECT_EQ(made.box.penetrating_frames, 0);
  EXPECT_EQ(made.box.flags, 0u);
}

TEST(Bounce, KeepsTheSquareOfRestitutionOfTheEnergyAtAnySize) {
  for (const double size_m : {0.001, 0.01, 0.1, 1.0})
    for (const bool ball : {false, true}) {
      expect_bounces({.size_m = size_m, .ball = ball}, 3);
      expect_bounces({.size_m = size_m, .height_m = 0.3, .restitution = 1.0, .ball = ball}, 3);
      expect_bounces({.size_m = size_m, .height_m = 1.0, .restitution = 0.5, .ball = ball}, 2);
    }
}

TEST(Bounce, KeepsTheSquareOfRestitutionOfTheEnergyAtAnySpeed) {
  for (const double height_m : {1e-4, 1e-3, 0.01, 0.1, 1.0})  // [m] of a drop
    for (const double size_m : {0.001, 0.02, 1.0})
      for (const double e : {0.9, 1.0})
        expect_bounces({.size_m = size_m, .height_m = height_m, .restitution = e}, 1);
}

TEST(Bounce, KeepsTheSquareOfRestitutionOfTheEnergyAtAnyRate) {
  for (const double rate_Hz : {500.0, 713.0, 1000.0, 2000.0, 4000.0})
    for (const double e : {0.2, 0.6, 0.95, 1.0})
      expect_bounces({.height_m = 0.2, .restitution = e, .rate_Hz = rate_Hz, .floor_first = e < 0.9},
                     e < 0.5 ? 1 : 3);
}

struct Tumble {
  double size_m = 0.02;
  double spin_rad_per_s = 1.0;
  double rate_Hz = 1000.0;
  bool ball = false;
};

/// What turns and bounces without loss keeps its energy: each bounce to rounding, but for the few whose gap
/// is closed in the pose that their time leads to, as that is found without the turn in the frame.
void expect_tumbles(const Tumble& c) {
  SCOPED_TRACE(::testing::Message() << (c.ball ? "ball" : "cube") << " of " << c.size_m << " m, "
                                    << c.spin_rad_per_s << " rad/s, " << c.rate_Hz << " Hz");
  Sandbox box;
  box.world.gravity_W = {0, 0, -kGravity};
  box.settings.dt_s = 1.0 / c.rate_Hz;
  const double half = 0.5 * c.size_m;
  box.add_fixed(make_box(c.size_m * Vec3(50, 50, 0.5)), {Mat3::Identity(), {0, 0, -half}});
  box.add(c.ball ? make_icosphere(3, half) : make_box({half, half, half}),
          {exp_rotation({0.3, 0.5, 0.1}), {0, 0, 3.0 * c.size_m}},
          {Vec3::Zero(), c.spin_rad_per_s * Vec3(1.0, 0.5, 0.2)});
  box.bounce(1.0);
  const double energy = box.energy();
  int hits = 0;
  for (int frames = 0; hits < 120; ++frames) {
    ASSERT_LT(frames, 60.0 * c.rate_Hz);
    box.step();
    hits += box.report.impacts;
  }
  box.step(2);
  EXPECT_NEAR(box.energy(), energy, 5e-3 * energy);
  EXPECT_EQ(box.penetrating_frames, 0);
}

TEST(Bounce, WhatTumblesKeepsItsEnergy) {
  for (const bool ball : {false, true})
    for (Tumble c : testing::sampled(std::vector<Tumble>{{},
                                                         {.spin_rad_per_s = 0.0},
                                                         {.spin_rad_per_s = 5.0},
                                                         {.spin_rad_per_s = 20.0},
                                                         {.size_m = 0.004},
                                                         {.size_m = 0.004, .rate_Hz = 4000.0},
                                                         {.rate_Hz = 4000.0}},
                                     4)) {
      c.ball = ball;
      expect_tumbles(c);
    }
}

struct HeadOn {
  double size_a_m = 0.02, size_b_m = 0.02;  // of the cubes
  double u_a = 1.0, u_b = -0.5;             // their velocities along x [m/s]
  double gap_m = 0.03;
  double restitution = 1.0;
  double rate_Hz = 1000.0;
};

/// Two cubes that meet without gravity part from where they met, also where the light one leaves much faster
/// than it came.
void expect_head_on(const HeadOn& c) {
  SCOPED_TRACE(::testing::Message() << c.size_a_m << " m at " << c.u_a << " m/s, " << c.size_b_m << " m at "
                                    << c.u_b << " m/s, e " << c.restitution << ", " << c.rate_Hz << " Hz");
  Sandbox box;
  box.settings.dt_s = 1.0 / c.rate_Hz;
  const double a = 0.5 * c.size_a_m;
  const double b = 0.5 * c.size_b_m;
  const Vec3 to_b(a + c.gap_m + b, 0, 0);
  box.add(make_box({a, a, a}), {}, {{c.u_a, 0, 0}, Vec3::Zero()});
  box.add(make_box({b, b, b}), {Mat3::Identity(), to_b}, {{c.u_b, 0, 0}, Vec3::Zero()});
  box.bounce(c.restitution);
  const double skin = tolerances::kSkin * std::sqrt(3.0) * std::max(c.size_a_m, c.size_b_m);
  const double m_a = box.world.bodies[0].mass_kg;
  const double m_b = box.world.bodies[1].mass_kg;
  const double impulse = (1.0 + c.restitution) * (c.u_a - c.u_b) * m_a * m_b / (m_a + m_b);
  const double v_a = c.u_a - impulse / m_a;
  const double v_b = c.u_b + impulse / m_b;
  const double met_s = (c.gap_m - skin) / (c.u_a - c.u_b);
  const double end_s = std::ceil(2.0 * met_s * c.rate_Hz) / c.rate_Hz;
  box.run(end_s);
  EXPECT_NEAR(box.X(0).p.x(), c.u_a * met_s + v_a * (end_s - met_s), 1e-9 * c.gap_m);
  EXPECT_NEAR(box.X(1).p.x(), to_b.x() + c.u_b * met_s + v_b * (end_s - met_s), 1e-9 * c.gap_m);
  EXPECT_NEAR(box.V(1).v.x() - box.V(0).v.x(), c.restitution * (c.u_a - c.u_b), 1e-9 * (c.u_a - c.u_b));
  EXPECT_EQ(box.penetrating_frames, 0);
}

TEST(Bounce, BodiesThatMoveIntoEachOtherPartFromWhereTheyMet) {
  for (const HeadOn& c :
       {HeadOn{}, HeadOn{.u_b = 0.4}, HeadOn{.restitution = 0.0}, HeadOn{.restitution = 0.4},
        HeadOn{.size_b_m = 0.008, .u_b = 0.0},
        HeadOn{.size_a_m = 0.005, .u_a = 0.0, .u_b = -1.0, .rate_Hz = 500.0},
        HeadOn{.size_a_m = 0.001, .size_b_m = 0.002, .u_a = 0.01, .u_b = -0.02, .gap_m = 0.001},
        HeadOn{.size_a_m = 1.0, .size_b_m = 2.0, .gap_m = 0.1, .restitution = 0.7, .rate_Hz = 4000.0},
        HeadOn{.u_a = 0.002, .u_b = -0.001, .gap_m = 1e-4}})
    expect_head_on(c);
}

/// A ball that hits an equal one aside, both icospheres that lie alike: by symmetry two parallel faces meet,
/// their impulse acts at the middle between the balls, and both spin alike. Which faces, and where, follows
/// from the planes alone.
void expect_oblique(double radius_m, double speed, double aside, double rate_Hz) {
  SCOPED_TRACE(::testing::Message() << radius_m << " m, " << speed << " m/s, " << aside << " radii aside, "
                                    << rate_Hz << " Hz");
  Sandbox box;
  box.settings.dt_s = 1.0 / rate_Hz;
  const Polytope shape = make_icosphere(2, radius_m);
  box.add(shape, {Mat3::Identity(), {-4.0 * radius_m, 0, 0}}, {{speed, 0, 0}, Vec3::Zero()});
  box.add(shape, {Mat3::Identity(), {0, aside * radius_m, 0}});
  box.bounce(1.0);
  const double energy = box.energy();
  const double skin = tolerances::kSkin * box.world.bodies[0].part->size;
  // The faces of the two are apart by n.(x_b - x_a) - 2 offset; the ball stops where the last ones are.
  double met_x_m = -4.0 * radius_m;
  Vec3 n = Vec3::Zero();
  for (const Polytope::Face& face : shape.faces) {
    if (!(face.normal.x() > 0.0)) continue;
    const double x = (face.normal.y() * aside * radius_m - 2.0 * face.offset - skin) / face.normal.x();
    if (n.isZero(0.0) || x > met_x_m) {
      met_x_m = x;
      n = face.normal;
    }
  }
  const Vec3 half = 0.5 * (Vec3(0, aside * radius_m, 0) - Vec3(met_x_m, 0, 0));
  const Vec3 lever = half.cross(n);
  const double mass_kg = box.world.bodies[0].mass_kg;
  const double inertia = box.world.bodies[0].inertia_B(0, 0);
  const double impulse = speed * n.x() / (1.0 / mass_kg + lever.squaredNorm() / inertia);
  const double spin = impulse * lever.norm() / inertia;
  box.run(std::ceil(8.0 * radius_m / speed * rate_Hz) / rate_Hz);
  EXPECT_NEAR(box.V(0).w.norm(), spin, 1e-6 * spin);
  EXPECT_NEAR(box.V(1).w.norm(), spin, 1e-6 * spin);
  EXPECT_NEAR((box.V(1).v - n * (impulse / mass_kg)).norm(), 0.0, 1e-6 * speed);
  EXPECT_NEAR(box.energy(), energy, 1e-9 * energy);
}

TEST(Bounce, ABallHitAsideSpinsAsThePlacesOfTheFacesSay) {
  expect_oblique(0.015, 0.5, 1.0, 1000.0);
  expect_oblique(0.015, 0.5, 1.0, 500.0);
  expect_oblique(0.015, 2.0, 0.6, 4000.0);
  expect_oblique(0.001, 0.1, 1.2, 1000.0);
  expect_oblique(0.3, 1.0, 0.9, 2000.0);
  expect_oblique(0.015, 0.5, 0.2, 1000.0);
}

/// An impact goes through a row of equal cubes within a frame: the last one leaves as if it had been hit by
/// the first.
TEST(Bounce, AnImpactGoesThroughARowAtItsTimes) {
  for (const double rate_Hz : testing::frame_rates_Hz())
    for (const double gap_m : {2e-6, 1e-5}) {
      SCOPED_TRACE(::testing::Message() << rate_Hz << " Hz, gaps of " << gap_m << " m");
      Sandbox box;
      box.settings.dt_s = 1.0 / rate_Hz;
      const double half = 0.01;
      const double speed = 0.7;
      const double start_m = 0.0213;
      for (int i = 0; i < 4; ++i)
        box.add(make_box({half, half, half}), {Mat3::Identity(), {i * (2.0 * half + gap_m), 0, 0}});
      box.add(make_box({half, half, half}), {Mat3::Identity(), {-2.0 * half - start_m, 0, 0}},
              {{speed, 0, 0}, Vec3::Zero()});
      box.bounce(1.0);
      const double skin = tolerances::kSkin * std::sqrt(3.0) * 2.0 * half;
      const double passed_s = (start_m - skin + 3.0 * (gap_m - skin)) / speed;
      box.run(0.06);
      EXPECT_NEAR(box.X(3).p.x(), 3.0 * (2.0 * half + gap_m) + speed * (0.06 - passed_s), 1e-9);
      for (const int i : {0, 1, 2})
        EXPECT_NEAR(box.X(i).p.x(), i * (2.0 * half + gap_m) + gap_m - skin, 1e-9);
      EXPECT_EQ(box.penetrating_frames, 0);
    }
}

struct OnResting {
  double height_m = 0.1;
  double rate_Hz = 1000.0;
  double restitution = 0.8;  // of the body that falls
  double of_others = 0.0;    // of what lies there, among itself and with the floor
  double size_m = 0.02;      // of the cube that falls
  double under_m = 0.02;     // of those that lie there
  int under = 1;
  Vec3 up = {0, 0, 1};
  ResponseModel response = ResponseModel::kConstraint;
};

/// A cube that falls on others, which lie on a floor, leaves them as it would leave the floor.
void expect_bounces_on_resting(const OnResting& c) {
  SCOPED_TRACE(::testing::Message() << c.height_m << " m, " << c.rate_Hz << " Hz, e " << c.restitution
                                    << " and " << c.of_others << ", " << c.size_m << " m on " << c.under
                                    << " of " << c.under_m << " m, up " << c.up.transpose());
  Sandbox box;
  const Mat3 R = testing::rotation_between(Vec3::UnitZ(), c.up.normalized());
  const auto at = [&](double z) { return Pose{R, R * Vec3(0, 0, z)}; };
  const auto cube = [](double size) { return make_box(Vec3::Constant(0.5 * size)); };
  const auto skin = [](double size) { return tolerances::kSkin * std::sqrt(3.0) * size; };
  box.world.gravity_W = R * Vec3(0, 0, -kGravity);
  box.settings.dt_s = 1.0 / c.rate_Hz;
  box.settings.response = c.response;
  box.add_fixed(make_box(c.under_m * Vec3(4, 4, 0.5)), at(-0.5 * c.under_m));
  double top = 0.0;
  for (int i = 0; i < c.under; ++i) {
    box.add(cube(c.under_m), at(top + skin(c.under_m) + 0.5 * c.under_m));
    top += skin(c.under_m) + c.under_m;
  }
  const int body = box.add(cube(c.size_m), at(top + c.height_m + 0.5 * c.size_m));
  box.bounce(c.restitution);
  const int bodies = body + 1;
  for (int i = 0; i < body; ++i)
    for (int k = 0; k < body; ++k)
      box.settings.impacts.restitution.coefficients[static_cast<std::size_t>(i * bodies + k)] = c.of_others;
  const double gap = skin(std::max(c.size_m, c.under_m));
  const double fall = c.height_m - gap;
  const double share = c.restitution * c.restitution;
  const double impact_s = std::sqrt(2.0 * fall / kGravity);
  const Vec3 up = R.col(2);
  const double rest_z = top + gap + 0.5 * c.size_m;
  double apex = 0.0;
  const int frames = static_cast<int>((impact_s * (1.0 + c.restitution)) * c.rate_Hz);
  for (int i = 0; i < frames; ++i) {
    box.step();
    for (int lies = 1; lies < body; ++lies) {
      const double z = skin(c.under_m) + 0.5 * c.under_m + (lies - 1) * (skin(c.under_m) + c.under_m);
      ASSERT_NEAR(up.dot(box.X(lies).p), z, 0.5 * skin(c.under_m)) << "frame " << i;
    }
  }
  const double v = up.dot(box.V(body).v);
  apex = up.dot(box.X(body).p) - rest_z + v * v / (2.0 * kGravity);
  EXPECT_NEAR(apex, share * fall, 1e-6 * share * fall);
  EXPECT_EQ(box.penetrating_frames, 0);
}

TEST(Bounce, OnABodyThatLiesOnAFloorIsAsOnTheFloor) {
  for (const ResponseModel response : {ResponseModel::kConstraint, ResponseModel::kPenalty})
    for (OnResting c :
         {OnResting{}, OnResting{.height_m = 0.01}, OnResting{.height_m = 1.0}, OnResting{.rate_Hz = 500.0},
          OnResting{.rate_Hz = 4000.0}, OnResting{.restitution = 0.5, .of_others = 0.9},
          OnResting{.restitution = 1.0, .of_others = 0.3}, OnResting{.restitution = 1.0, .of_others = 1.0},
          OnResting{.under_m = 0.0431}, OnResting{.size_m = 0.0431}, OnResting{.under = 2},
          OnResting{.under_m = 0.0431, .under = 2}, OnResting{.of_others = 0.5, .under = 3},
          OnResting{.up = {1, 0, 0}}, OnResting{.under = 2, .up = {0.3, -0.5, 0.8}},
          OnResting{.size_m = 0.002, .under_m = 0.002}, OnResting{.size_m = 1.0, .under_m = 1.0}}) {
      c.response = response;
      expect_bounces_on_resting(c);
    }
}

/// What merely touches passes an impact on: only what carries is solved together with it.
TEST(Bounce, ACradleOnAFloorPassesTheImpactOn) {
  for (const double rate_Hz : testing::frame_rates_Hz()) {
    SCOPED_TRACE(::testing::Message() << rate_Hz << " Hz");
    Sandbox box;
    box.world.gravity_W = {0, 0, -kGravity};
    box.settings.dt_s = 1.0 / rate_Hz;
    const double half = 0.01;
    const double skin = tolerances::kSkin * std::sqrt(3.0) * 2.0 * half;
    box.add_fixed(make_box(Vec3(0.5, 0.1, half)), {Mat3::Identity(), {0, 0, -half}});
    for (int i = 0; i < 3; ++i)
      box.add(make_box(Vec3::Constant(half)), {Mat3::Identity(), {i * (2.0 * half + skin), 0, half + skin}});
    box.add(make_box(Vec3::Constant(half)), {Mat3::Identity(), {-2.0 * half - 0.02, 0, half + skin}},
            {{0.5, 0, 0}, Vec3::Zero()});
    box.bounce(1.0);
    box.run(0.1);
    EXPECT_NEAR(box.V(3).v.x(), 0.5, 1e-6);
    for (const int i : {1, 2, 4}) EXPECT_NEAR(box.V(i).v.x(), 0.0, 1e-6);
  }
}

/// What lies, or was let down, lies still, however elastic: impacts end, and nothing leaves its place.
TEST(Bounce, WhatLiesDoesNotBounce) {
  for (const double e : {0.3, 0.9})
    for (const double rate_Hz : testing::frame_rates_Hz())
      for (const double size_m : {0.002, 0.04, 1.0})
        for (const int stacked : {1, 4}) {
          SCOPED_TRACE(::testing::Message()
                       << stacked << " of " << size_m << " m, e " << e << ", " << rate_Hz << " Hz");
          Sandbox box;
          box.world.gravity_W = {0, 0, -kGravity};
          box.settings.dt_s = 1.0 / rate_Hz;
          const double half = 0.5 * size_m;
          const double skin = tolerances::kSkin * std::sqrt(3.0) * size_m;
          for (const double side : {-0.8, 0.8})  // two rails
            box.add_fixed(make_box(size_m * Vec3(0.2, 1, 0.1)),
                          {Mat3::Identity(), {side * half, 0, -0.1 * size_m}});
          for (int i = 0; i < stacked; ++i)
            box.add(make_box({half, half, half}),
                    {Mat3::Identity(), {0, 0, half + skin + i * (size_m + skin)}});
          box.bounce(e);
          box.rub(0.4);
          for (int i = 0; i < static_cast<int>(0.5 * rate_Hz); ++i) {
            box.step();
            ASSERT_EQ(box.report.impacts, 0) << "frame " << i;
          }
          for (int i = 0; i < stacked; ++i)
            EXPECT_NEAR(box.X(2 + i).p.z(), half + skin + i * (size_m + skin), 0.5 * skin);
          EXPECT_EQ(box.penetrating_frames, 0);
        }
}

}  // namespace
}  // namespace tactum::bounce_test
