#include "tactum/loop/smoothing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "tactum/base/random.h"

namespace tactum::smoothing_test {
namespace {

/// The paper's text for numbers that rise, and mirrored for numbers that fall.
double published(double F0, double F1, double F_max) {
  if (F1 < F0) return -published(-F0, -F1, F_max);
  if (F1 - F0 > 2 * F_max) return F0 + F_max;
  if (F1 - F0 > F_max) return (F0 + F1) / 2;
  return F1;
}

TEST(Smoothing, IsThePublishedSchemeAlongALine) {
  Random random(51);
  for (int i = 0; i < 20000; ++i) {
    const double F0 = random.uniform(-5, 5);
    const double F1 = random.uniform(-5, 5);
    const double F_max = random.uniform(0, 3);
    const Vec3 shown = smoothed({0, F0, 0}, {0, F1, 0}, F_max);
    EXPECT_NEAR(shown.y(), published(F0, F1, F_max), 1e-14) << "seed 51, try " << i;
    EXPECT_EQ(shown.x(), 0.0);
  }
}

TEST(Smoothing, StepsAreBoundedInEveryDirectionAndTurnWithTheFrame) {
  Random random(52);
  const auto vector = [&random] {
    const double x = random.uniform(-5, 5);
    const double y = random.uniform(-5, 5);
    const double z = random.uniform(-5, 5);
    return Vec3(x, y, z);
  };
  const Mat3 R = Quat(0.5, -0.5, 0.5, 0.5).toRotationMatrix();
  for (int i = 0; i < 20000; ++i) {
    const Vec3 F0 = vector();
    const Vec3 F1 = vector();
    const double F_max = random.uniform(0, 3);
    const Vec3 shown = smoothed(F0, F1, F_max);
    EXPECT_LE((shown - F0).norm(), F_max + 1e-14) << "seed 52, try " << i;
    EXPECT_LT((smoothed(R * F0, R * F1, F_max) - R * shown).norm(), 1e-14) << "seed 52, try " << i;
  }
}

TEST(Smoothing, ReachesAConstantForceAndTreatsTorqueApart) {
  SmoothingSettings settings;
  settings.beyond_hand_N_per_s = settings.beyond_hand_Nm_per_s = std::numeric_limits<double>::infinity();
  SmoothingState state;
  const Wrench computed{{2.2, 0, 0}, {0, 0, 0.005}};
  Wrench shown = smooth_wrench(settings, 0.001, {}, state, computed);
  EXPECT_EQ(shown.f.x(), 0.5);
  EXPECT_EQ(shown.t.z(), 0.005) << "a small torque is not held back by a large force";
  const double expected[] = {1.0, 1.5, 1.85, 2.2, 2.2};
  for (const double force : expected) {
    shown = smooth_wrench(settings, 0.001, {}, state, computed);
    EXPECT_NEAR(shown.f.x(), force, 1e-15);
  }
  settings.max_force_N_per_s = std::numeric_limits<double>::infinity();
  EXPECT_EQ(smooth_wrench(settings, 0.001, {}, state, {{-90, 0, 0}, {0, 0, 0}}).f.x(), -90.0);
}

struct Leap {
  double dt_s = 0.001;
  double to_N = 3.0;
  double stiffness_N_per_m = 600.0;
  double speed_m_per_s = 0.0;
};

TEST(Smoothing, AForceChangesAsTheHandMovesOrAsSlowlyAsTold) {
  for (const Leap& c :
       {Leap{}, Leap{.dt_s = 2.5e-4}, Leap{.to_N = 0.3}, Leap{.speed_m_per_s = 0.2},
        Leap{.stiffness_N_per_m = 2000.0, .speed_m_per_s = 0.1}, Leap{.speed_m_per_s = 10.0}}) {
    SCOPED_TRACE(::testing::Message() << c.dt_s << " s, " << c.to_N << " N, " << c.speed_m_per_s << " m/s");
    const SmoothingSettings settings;
    SmoothingState state;
    const Twist moved{{0, c.speed_m_per_s * c.dt_s, 0}, Vec3::Zero()};
    const double rate_N_per_s = std::clamp(c.stiffness_N_per_m * c.speed_m_per_s,
                                           settings.beyond_hand_N_per_s, settings.max_force_N_per_s);
    double before = 0.0;
    int frames = 0;
    for (; frames < 10000 && before < c.to_N; ++frames) {
      const Wrench shown =
          smooth_wrench(settings, c.dt_s, explained_by(moved, c.stiffness_N_per_m, 0.3, 0.05), state,
                        {{0, 0, c.to_N}, Vec3::Zero()});
      ASSERT_LE(shown.f.z() - before, rate_N_per_s * c.dt_s * (1.0 + 1e-9));
      before = shown.f.z();
    }
    EXPECT_EQ(before, c.to_N);
    EXPECT_NEAR(frames * c.dt_s, c.to_N / rate_N_per_s, 2.0 * c.dt_s);
  }
}

TEST(Smoothing, WhatBuzzesAtTheRateOfTheFramesStaysBelowWhatIsFelt) {
  Random random(53);
  for (const double dt_s : {0.001, 2.5e-4})
    for (const double size_N : {0.03, 0.3, 5.0}) {
      SmoothingState state;
      Vec3 last = Vec3::Zero(), last_step = Vec3::Zero();
      for (int i = 0; i < 5000; ++i) {
        const Vec3 noise(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
        const Vec3 computed = Vec3(0, 0, 2.0) + size_N * (i % 2 == 0 ? 1.0 : -1.0) * noise;
        const Wrench shown = smooth_wrench({}, dt_s, {10.0, 1.0}, state, {computed, 0.02 * computed});
        const Vec3 step = shown.f - last;
        const double to_and_fro_N = step.dot(last_step) < 0.0 ? std::min(step.norm(), last_step.norm()) : 0.0;
        ASSERT_LE(to_and_fro_N, 0.02 * dt_s / 0.001);
        last = shown.f;
        last_step = step;
      }
    }
}

TEST(Smoothing, IsThePublishedOneToTheLetterWhereNothingElseIsAsked) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const SmoothingSettings published{.beyond_hand_N_per_s = kInfinity,
                                    .beyond_hand_Nm_per_s = kInfinity,
                                    .reversal_N_per_s = kInfinity,
                                    .reversal_Nm_per_s = kInfinity};
  Random random(54);
  SmoothingState state;
  Vec3 f = Vec3::Zero(), t = Vec3::Zero();
  for (int i = 0; i < 5000; ++i) {
    const Vec3 noise(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    const Wrench shown = smooth_wrench(published, 0.001, {}, state, {noise, 0.02 * noise});
    f = smoothed(f, noise, 0.5);
    t = smoothed(t, 0.02 * noise, 0.01);
    ASSERT_EQ(shown.f, f);
    ASSERT_EQ(shown.t, t);
  }
}

}  // namespace
}  // namespace tactum::smoothing_test
