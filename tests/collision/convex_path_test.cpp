#include "tactum/collision/convex_path.h"

#include <gtest/gtest.h>

#include "collision/cases.h"
#include "tactum/collision/closest_features.h"
#include "tactum/math/path_search.h"

namespace tactum {
namespace {

double distance(const Polytope& A, const Polytope& B, const Pose& X_AB) {
  PairCache cache;
  return closest_features(A, B, X_AB, cache).distance;
}

/// Motions from a fraction of the gap to far through, with turns up to a radian: no sample of the part that
/// is called free touches, and where it ends the pieces are near.
TEST(ConvexPath, IsFreeUpToWhereSamplesOfTheDistanceTouch) {
  Random random(53);
  const auto shapes = cases::shapes(random, true);
  int free = 0, ended = 0;
  const int runs = cases::full() ? 20000 : cases::some_of(2000);
  for (int i = 0; i < runs; ++i) {
    const Polytope& A = shapes[std::size_t(random.index(int(shapes.size())))].polytope;
    const Polytope& B = shapes[std::size_t(random.index(int(shapes.size())))].polytope;
    const double size = std::max(A.extent.size, B.extent.size);
    const Pose start{cases::random_rotation(random), cases::random_vector(random, size)};
    if (!(distance(A, B, start) > 1e-4 * size)) continue;
    const RelativeMotion motion{start,
                                {cases::random_vector(random, size * std::pow(10.0, random.uniform(-4, 1))),
                                 cases::random_vector(random, std::pow(10.0, random.uniform(-4, 0)))},
                                start.p};
    const double path = convex_path_free(A, B, motion, {});
    ASSERT_GE(path, 0.0);
    ASSERT_LE(path, 1.0);
    const bool may_rise = motion.by.w.norm() <= kHardlyTurns;  // and need not go on lines
    for (int k = may_rise ? 40 : 0; k <= 40; ++k)
      ASSERT_GT(distance(A, B, motion.at(path * k / 40)), 0.0) << "case " << i;
    if (path == 1.0) {
      ++free;
      continue;
    }
    ++ended;
    const double travel =
        motion.by.v.norm() + motion.by.w.norm() * (B.extent.center.norm() + B.extent.radius);
    EXPECT_LT(distance(A, B, motion.at(path)), 1e-3 * travel) << "case " << i;
  }
  EXPECT_GT(free, runs / 20);
  EXPECT_GT(ended, runs / 50);
}

/// A block that slides in a gap of a micrometre, 1 mm to 10 m in a step: the tunnel of the paper.
TEST(ConvexPath, LetsABlockThroughATunnel) {
  const Polytope wall = make_box({50.0, 2.0, 0.5});
  const Polytope cube = make_box({0.5, 0.5, 0.5});
  for (const double gap : {1e-4, 1e-6, 1e-9})
    for (const double step : {1e-3, 0.1, 10.0})
      EXPECT_EQ(
          convex_path_free(wall, cube,
                           {{Mat3::Identity(), {-20.0, 0.1, 1.0 + gap}}, {{step, 0, 0}, Vec3::Zero()}}, {}),
          1.0);
}

/// A rod that turns past a pin, and is there on neither side.
TEST(ConvexPath, SeesAPinInTheWayOfARodThatTurns) {
  const Polytope pin = make_box({0.0005, 0.0005, 0.01});
  Polytope rod = make_box({0.05, 0.001, 0.005});
  const Pose start{exp_rotation({0, 0, -0.5}), {-0.03, 0, 0}};
  EXPECT_LT(convex_path_free(pin, rod, {start, {Vec3::Zero(), {0, 0, 1.0}}, start.p}, {}), 0.5);
  EXPECT_GT(convex_path_free(pin, rod, {start, {Vec3::Zero(), {0, 0, 1.0}}, start.p}, {}), 0.4);
  EXPECT_EQ(convex_path_free(pin, rod, {start, {Vec3::Zero(), {0, 0, -1.0}}, start.p}, {}), 1.0);
}

}  // namespace
}  // namespace tactum
