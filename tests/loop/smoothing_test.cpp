#include "tactum/loop/smoothing.h"

#include <gtest/gtest.h>

#include <limits>

#include "tactum/base/random.h"

namespace tactum {
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
  settings.max_force_step_N = 0.5;
  settings.max_torque_step_Nm = 0.01;
  SmoothingState state;
  const Wrench computed{{2.2, 0, 0}, {0, 0, 0.005}};
  Wrench shown = smooth_wrench(settings, 0.001, state, computed);
  EXPECT_EQ(shown.f.x(), 0.5);
  EXPECT_EQ(shown.t.z(), 0.005) << "a small torque is not held back by a large force";
  const double expected[] = {1.0, 1.5, 1.85, 2.2, 2.2};
  for (const double force : expected) {
    shown = smooth_wrench(settings, 0.001, state, computed);
    EXPECT_NEAR(shown.f.x(), force, 1e-15);
  }
  settings.max_force_step_N = std::numeric_limits<double>::infinity();
  EXPECT_EQ(smooth_wrench(settings, 0.001, state, {{-90, 0, 0}, {0, 0, 0}}).f.x(), -90.0);
}

}  // namespace
}  // namespace tactum
