#include "tactum/math/screw.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tactum/base/random.h"

namespace tactum {
namespace {

Vec3 random_vector(Random& random, double size) {
  const double x = random.uniform(-size, size);
  const double y = random.uniform(-size, size);
  const double z = random.uniform(-size, size);
  return {x, y, z};
}

/// Of every size: series stand in for functions below a few degrees.
constexpr double kTurns[] = {1e-7, 1e-3, 0.01, 0.02, 0.035, 0.05, 1.5};

TEST(Screw, LogUndoesExp) {
  Random random(1);
  for (int i = 0; i < 10000; ++i)
    for (const double turn : kTurns) {
      const Vec3 w = random_vector(random, turn);
      EXPECT_LT((log_rotation(exp_rotation(w)) - w).norm(), 1e-14 * std::min(1.0, 100.0 * turn))
          << w.transpose();
    }
}

TEST(Screw, ExpIsTheTurnAboutItsAxis) {
  Random random(5);
  for (int i = 0; i < 10000; ++i)
    for (const double turn : kTurns) {
      const Vec3 w = random_vector(random, turn);
      using Long = Eigen::Matrix<long double, 3, 1>;
      const Long axis = w.cast<long double>();
      const Eigen::AngleAxis<long double> about(axis.norm(), axis.normalized());
      EXPECT_LT((exp_rotation(w) - about.toRotationMatrix().cast<double>()).norm(), 1e-15) << w.transpose();
    }
}

TEST(Screw, TwistBetweenReachesTheOtherPose) {
  Random random(2);
  for (int i = 0; i < 1000; ++i) {
    const Pose a{exp_rotation(random_vector(random, 2.0)), random_vector(random, 0.3)};
    const Pose b{exp_rotation(random_vector(random, 2.0)), random_vector(random, 0.3)};
    const Pose reached = advanced(a, twist_between(a, b, 0.001), 0.001);
    EXPECT_LT((reached.R - b.R).norm() + (reached.p - b.p).norm(), 1e-12);
  }
}

TEST(Spatial, PowerDoesNotDependOnTheReferencePoint) {
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const Twist V{random_vector(random, 1), random_vector(random, 1)};
    const Wrench F{random_vector(random, 1), random_vector(random, 1)};
    const Vec3 r = random_vector(random, 1);
    EXPECT_NEAR(power(F, V), power(moved(F, r), moved(V, r)), 1e-14);
  }
}

TEST(Pose, RelativePoseIsInverseTimes) {
  Random random(4);
  const Pose a{exp_rotation(random_vector(random, 2.0)), random_vector(random, 0.3)};
  const Pose b{exp_rotation(random_vector(random, 2.0)), random_vector(random, 0.3)};
  const Pose ab = relative_pose(a, b);
  const Vec3 p(0.1, -0.2, 0.3);
  EXPECT_LT((a * (ab * p) - b * p).norm(), 1e-15);
}

}  // namespace
}  // namespace tactum
