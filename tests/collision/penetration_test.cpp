#include "tactum/collision/penetration.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "collision/cases.h"
#include "oracles/exhaustive.h"
#include "tactum/base/tolerances.h"
#include "tactum/collision/closest_features.h"

namespace tactum {
namespace {

/// An overlapping pose: centres nearer than the smaller radius.
Pose overlapping(Random& random, const Polytope& A, const Polytope& B) {
  Pose X{cases::random_rotation(random), Vec3::Zero()};
  const double radius = 0.6 * std::min(A.extent.radius, B.extent.radius);
  const Vec3 offset = cases::random_unit(random) * random.uniform(0.0, radius);
  X.p = A.extent.center - X.R * B.extent.center + offset;
  return X;
}

Pose moved_away(const Pose& X_AB, const Vec3& by) { return {X_AB.R, X_AB.p - by}; }  // A by +by is B by -by

TEST(Penetration, ColdStartOfSmallPiecesIsTheGlobalMinimum) {
  const std::uint64_t seed = 41;
  Random random(seed);
  const auto shapes = cases::shapes(random, false);
  const int poses = cases::full() ? 100000 : cases::some_of(3000);
  for (int i = 0; i < poses; ++i) {
    const cases::Shape& a = shapes[std::size_t(random.index(int(shapes.size())))];
    const cases::Shape& b = shapes[std::size_t(random.index(int(shapes.size())))];
    const Pose X = overlapping(random, a.polytope, b.polytope);
    PairCache cache;
    const PairDistance deep = penetration_depth(a.polytope, b.polytope, X, cache);
    const double axes = double(oracle::axes_separation(a.polytope, b.polytope, X));
    const double tolerance = 2e-9 * std::max(a.polytope.extent.size, b.polytope.extent.size);
    if (axes > 0.0) continue;  // separated after all: a thin piece
    ASSERT_NEAR(deep.distance, axes, tolerance)
        << a.name << " / " << b.name << " seed " << seed << " case " << i << " " << cases::describe(X);
    ASSERT_EQ(oracle::complaint(a.polytope, b.polytope, X, deep, tolerance), "")
        << a.name << " / " << b.name << " seed " << seed << " case " << i << " " << cases::describe(X);
  }
}

TEST(Penetration, MovingByTheDepthJustSeparates) {
  const std::uint64_t seed = 42;
  Random random(seed);
  const auto shapes = cases::shapes(random, true);
  for (int i = 0; i < cases::some_of(2000); ++i) {
    const cases::Shape& a = shapes[std::size_t(random.index(int(shapes.size())))];
    const cases::Shape& b = shapes[std::size_t(random.index(int(shapes.size())))];
    const Pose X = overlapping(random, a.polytope, b.polytope);
    PairCache cache;
    const PairDistance deep = closest_features(a.polytope, b.polytope, X, cache);
    if (deep.distance >= 0.0) continue;
    const double size = std::max(a.polytope.extent.size, b.polytope.extent.size);
    PairCache fresh;
    const PairDistance after = closest_features(
        a.polytope, b.polytope, moved_away(X, deep.normal * (1e-6 * size - deep.distance)), fresh);
    ASSERT_NEAR(after.distance, 1e-6 * size, 1e-8 * size)
        << a.name << " / " << b.name << " seed " << seed << " case " << i << " " << cases::describe(X);
  }
}

TEST(Penetration, WalkMissesFewGlobalMinimaOfCompactShapes) {
  const std::uint64_t seed = 43;
  Random random(seed);
  const std::vector<cases::Shape> shapes = {
      {"sphere 162", make_icosphere(2, 0.025)},
      {"hull 150", cases::random_hull(random, 150, {0.02, 0.025, 0.03})},
      {"prism 64", make_prism(64, 0.02, 0.04)},
      {"box", make_box({0.02, 0.025, 0.03})}};
  int missed = 0;
  int total = 0;
  double worst = 0.0;
  for (int i = 0; i < cases::some_of(1000); ++i) {
    const cases::Shape& a = shapes[std::size_t(random.index(int(shapes.size())))];
    const cases::Shape& b = shapes[std::size_t(random.index(int(shapes.size())))];
    const Pose X = overlapping(random, a.polytope, b.polytope);
    PairCache cache;
    const double walked = penetration_depth(a.polytope, b.polytope, X, cache).distance;
    const double least = penetration_exhaustive(a.polytope, b.polytope, X).distance;
    ++total;
    const double size = std::max(a.polytope.extent.size, b.polytope.extent.size);
    ASSERT_LE(walked, least + 1e-9 * size);
    missed += walked < least - 1e-9 * size;
    worst = std::max(worst, least - walked);
  }
  std::printf("  seed %llu: %d of %d cold walks missed the global minimum, by %.3g mm at most\n",
              static_cast<unsigned long long>(seed), missed, total, worst * 1e3);
  EXPECT_LE(missed, total / 5);
}

TEST(Penetration, DeepSpheresAreMeasuredByExhaustion) {
  const Polytope sphere = make_icosphere(3, 0.025);
  const Pose X{Mat3::Identity(), {0.01, 0.002, -0.003}};
  const PairDistance deep = penetration_exhaustive(sphere, sphere, X);
  EXPECT_TRUE(deep.certified());
  EXPECT_NEAR(deep.distance, X.p.norm() - 0.05, 0.0005);
}

TEST(Penetration, FlatPiecesHaveTheDepthOfTheirPlane) {
  const Polytope square =
      *flat_polygon({{-0.01, -0.01, 0}, {0.01, -0.01, 0}, {0.01, 0.01, 0}, {-0.01, 0.01, 0}});
  const Polytope box = make_box({0.03, 0.03, 0.03});
  PairCache cache;
  const PairDistance inside = closest_features(box, square, {Mat3::Identity(), {0, 0, 0.028}}, cache);
  EXPECT_NEAR(inside.distance, -0.002, 1e-15);
  EXPECT_TRUE(inside.normal.isApprox(-Vec3::UnitZ()));
  PairCache coplanar_cache;
  const PairDistance coplanar =
      closest_features(square, square, {exp_rotation(Vec3(0, 0, 0.3)), {0.004, 0, 0}}, coplanar_cache);
  EXPECT_NEAR(coplanar.distance, 0.0, 1e-15);
  EXPECT_NEAR(std::abs(coplanar.normal.z()), 1.0, 1e-15);
  EXPECT_TRUE(coplanar.certified());
}

/// Depth along a direction against bisection by the distance query.
TEST(Penetration, AlongADirectionAgreesWithBisection) {
  const std::uint64_t seed = 45;
  Random random(seed);
  const auto shapes = cases::shapes(random, true);
  for (int i = 0; i < cases::some_of(1500); ++i) {
    const cases::Shape& a = shapes[std::size_t(random.index(int(shapes.size())))];
    const cases::Shape& b = shapes[std::size_t(random.index(int(shapes.size())))];
    const Pose X = overlapping(random, a.polytope, b.polytope);
    const Vec3 direction = cases::random_unit(random);
    PairCache cache;
    if (closest_features(a.polytope, b.polytope, X, cache).distance > -1e-6) continue;
    const PairDistance along = depth_along(a.polytope, b.polytope, X, direction);
    double inside = 0.0;
    double outside = 2.0 * (a.polytope.extent.radius + b.polytope.extent.radius);
    for (int k = 0; k < 50; ++k) {
      const double middle = 0.5 * (inside + outside);
      const PairDistance at =
          closest_features(a.polytope, b.polytope, moved_away(X, direction * middle), cache);
      (at.distance < 0.0 ? inside : outside) = middle;
    }
    ASSERT_TRUE(along.certified()) << a.name << " / " << b.name << " seed " << seed << " case " << i;
    ASSERT_NEAR(-along.distance, outside, 1e-7 * (a.polytope.extent.size + b.polytope.extent.size))
        << a.name << " / " << b.name << " seed " << seed << " case " << i << " " << cases::describe(X);
  }
}

TEST(Penetration, AlongADirectionThatMissesIsZero) {
  const Polytope box = make_box({0.01, 0.01, 0.01});
  const PairDistance past = depth_along(box, box, {Mat3::Identity(), {0.05, 0, 0}}, Vec3::UnitZ());
  EXPECT_EQ(past.distance, 0.0);
  EXPECT_FALSE(past.certified());
}

TEST(Penetration, NothingIsProvedAlongAPlaneThatHoldsBothPieces) {
  const Polytope square =
      *flat_polygon({{-0.01, -0.01, 0}, {0.01, -0.01, 0}, {0.01, 0.01, 0}, {-0.01, 0.01, 0}});
  Pose crossed{Mat3::Identity(), {0.003, 0.001, 0.002}};
  crossed.R.col(1) = Vec3::UnitZ();
  crossed.R.col(2) = -Vec3::UnitY();
  for (const Pose& X :
       {Pose{Mat3::Identity(), {0.3, 0.1, 0.0}}, Pose{Mat3::Identity(), {0.003, 0.001, 0.0}}, crossed})
    EXPECT_FALSE(depth_along(square, square, X, Vec3::UnitX()).certified()) << cases::describe(X);
}

/// Warm and cold must agree on the depth of a piece that is pushed slowly into another.
TEST(Penetration, WarmTrackingStaysCertified) {
  const std::uint64_t seed = 46;
  Random random(seed);
  const auto shapes = cases::shapes(random, true);
  int frames = 0;
  for (int run = 0; run < std::max(2, cases::some_of(60)); ++run) {
    const cases::Shape& a = shapes[std::size_t(random.index(int(shapes.size())))];
    const cases::Shape& b = shapes[std::size_t(random.index(int(shapes.size())))];
    Pose X = overlapping(random, a.polytope, b.polytope);
    const Vec3 v = cases::random_vector(random, 0.1);
    const Vec3 w = cases::random_vector(random, 2.0);
    PairCache cache;
    for (int frame = 0; frame < 200; ++frame) {
      X = advanced(X, {v, w}, 1e-3);
      const PairDistance deep = closest_features(a.polytope, b.polytope, X, cache);
      ++frames;
      ASSERT_EQ(oracle::complaint(a.polytope, b.polytope, X, deep,
                                  2e-9 * std::max(a.polytope.extent.size, b.polytope.extent.size)),
                "")
          << a.name << " / " << b.name << " seed " << seed << " run " << run << " frame " << frame;
    }
  }
  EXPECT_EQ(frames, 200 * std::max(2, cases::some_of(60)));
}

/// The cache of a pair may come from other pieces, or be anything: the answer is a certified depth all the
/// same.
TEST(Penetration, AnyMemoryGivesADepth) {
  const std::uint64_t seed = 47;
  Random random(seed);
  const auto shapes = cases::shapes(random, false);
  const auto anything = [&random] { return Feature{FeatureKind(random.index(3)), random.index(60) - 2}; };
  int compared = 0;
  for (int i = 0; i < cases::some_of(3000); ++i) {
    const cases::Shape& a = shapes[std::size_t(random.index(int(shapes.size())))];
    const cases::Shape& b = shapes[std::size_t(random.index(int(shapes.size())))];
    const Pose X = overlapping(random, a.polytope, b.polytope);
    PairCache cache;
    cache.a = anything();
    cache.b = anything();
    cache.normal_A = cases::random_unit(random);
    for (FeaturePair* pair : {&cache.candidate_minima[0], &cache.candidate_minima[1], &cache.explorer})
      *pair = {anything(), anything()};
    cache.turn = std::uint32_t(random.index(24));
    cache.explorer_starts = std::uint32_t(random.index(100));
    const double size = std::max(a.polytope.extent.size, b.polytope.extent.size);
    const PairDistance fresh = penetration_exhaustive(a.polytope, b.polytope, X);
    if (!fresh.certified()) continue;  // flat pieces that do not overlap
    ++compared;
    for (int frame = 0; frame < 16; ++frame) {
      const PairDistance deep = penetration_depth(a.polytope, b.polytope, X, cache);
      ASSERT_TRUE(deep.certified()) << a.name << " / " << b.name << " seed " << seed << " case " << i;
      ASSERT_LE(deep.distance, fresh.distance + 2e-9 * size)
          << a.name << " / " << b.name << " seed " << seed << " case " << i;
    }
  }
  EXPECT_GT(compared, cases::some_of(2500));
}

/// Boxes face to face, where feet lie between the facets: pushed sideways the translation out through a side
/// becomes the shortest one, and is found within a few frames.
TEST(Penetration, AlignedBoxesFindTheirSides) {
  const Polytope box = make_box({0.02, 0.03, 0.04});  // half extents
  PairCache cache;
  int late = 0;
  for (int frame = 0; frame < 200; ++frame) {
    const double slid = 2e-4 * frame;  // along x, until only a sliver of the 0.04 is over the other
    const Pose X{Mat3::Identity(), {slid, 0.0, 0.08 - 0.01}};
    const double depth = -penetration_depth(box, box, X, cache).distance;
    const double least = std::min(0.01, 0.04 - slid);
    ASSERT_GE(depth, least - 1e-10) << frame;
    late = depth > least + 1e-10 ? late + 1 : 0;
    ASSERT_LE(late, 20) << frame;
  }
}

}  // namespace
}  // namespace tactum
