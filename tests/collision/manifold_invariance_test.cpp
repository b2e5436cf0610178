/// Invariants of the manifolds of random contacts: swapped, renamed, moved, scaled, turned a little, never
/// empty.

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "collision/cases.h"
#include "collision/manifold_contact.h"

namespace tactum {
namespace {

using namespace manifold_tests;

/// A rectangle is clipped by its own coordinates, any other face side by side: B with a corner that is a hair
/// off square has the same patch.
TEST(Manifold, OfARectangleIsThatOfAFaceThatNearlyIsOne) {
  const std::uint64_t seed = 39;
  Random random(seed);
  int patches = 0;
  for (int i = 0; i < cases::some_of(5000); ++i) {
    SCOPED_TRACE("seed " + std::to_string(seed) + ", case " + std::to_string(i));
    const Polytope A = make_prism(3 + random.index(7), 0.02, 0.02);
    const Vec3 half(random.uniform(0.002, 0.03), random.uniform(0.002, 0.03), 0.01);
    constexpr double kHair = 1e-10;
    const auto brick = [&](double off) {
      std::vector<Vec3> corners;
      for (const double z : {-half.z(), half.z()})
        for (const Vec2& at : {Vec2(-1, -1), Vec2(1, -1), Vec2(1, 1 + off), Vec2(-1, 1)})
          corners.push_back({half.x() * at.x(), half.y() * at.y(), z});
      return *convex_hull(corners);
    };
    const Pose X{
        exp_rotation(cases::random_vector(random, 0.02)) * exp_rotation(Vec3(0, 0, random.uniform(-3, 3))),
        {random.uniform(-0.02, 0.02), random.uniform(-0.02, 0.02), -0.0202}};
    const Contact square = contact(A, brick(0.0), X, 5e-4);
    if (square.patch.points.size() != 4) continue;
    const Contact nearly = contact(A, brick(kHair), X, 5e-4);
    ASSERT_EQ(nearly.patch.points.size(), 4u);
    ++patches;
    expect_sound(square, 5e-4, 1e-12);
    EXPECT_NEAR(nearly.patch.area, square.patch.area, 1e-10);
    EXPECT_LT((centroid(nearly.patch) - centroid(square.patch)).norm(), 1e-8);
    const Vec3 u = any_orthogonal(square.patch.normal);
    EXPECT_NEAR(second_moment(nearly.patch, u, u), second_moment(square.patch, u, u), 1e-11);
  }
  EXPECT_GT(patches, cases::some_of(1000));
}

TEST(Manifold, SwappingAAndBTurnsTheNormalAndKeepsThePatch) {
  const std::uint64_t seed = 32;
  Random random(seed);
  for (int i = 0; i < cases::some_of(2000); ++i) {
    SCOPED_TRACE("seed " + std::to_string(seed) + ", case " + std::to_string(i));
    const Polytope A = make_prism(3 + random.index(7), 0.02, 0.02);
    const Polytope B = make_prism(3 + random.index(7), 0.02, 0.02);
    Pose X{exp_rotation(cases::random_vector(random, 0.02)) * exp_rotation(Vec3(0, 0, random.uniform(-3, 3))),
           {random.uniform(-0.02, 0.02), 0, -0.0202}};
    const Contact ab = contact(A, B, X, 5e-4);
    const Contact ba = contact(B, A, X.inverse(), 5e-4);
    if (ab.patch.points.empty()) {
      EXPECT_TRUE(ba.patch.points.empty());
      continue;
    }
    expect_sound(ab, 5e-4, 1e-12);
    EXPECT_LT((X.R * ba.patch.normal + ab.patch.normal).norm(), 1e-9);
    EXPECT_NEAR(ab.patch.area, ba.patch.area, 1e-9);
    EXPECT_LT((X * centroid(ba.patch) - centroid(ab.patch)).norm(), 1e-7);
  }
}

/// Where the patch is, how large and how it spreads: the same for any numbering of vertices, a
/// kilometre away (1e-12 m of the poses' own rounding), and for parts of 1 mm to 10 m.
TEST(Manifold, NamesPlaceAndScaleDoNotMatter) {
  const std::uint64_t seed = 33;
  Random random(seed);
  int patches = 0;
  for (int i = 0; i < cases::some_of(1000); ++i) {
    SCOPED_TRACE("seed " + std::to_string(seed) + ", case " + std::to_string(i));
    const Polytope A = make_prism(3 + random.index(7), 0.02, 0.02);
    const Polytope B = make_prism(3 + random.index(7), 0.02, 0.02);
    const Pose X{
        exp_rotation(cases::random_vector(random, 0.02)) * exp_rotation(Vec3(0, 0, random.uniform(-3, 3))),
        {random.uniform(-0.02, 0.02), 0, -0.0202}};
    const Contact here = contact(A, B, X, 5e-4);
    if (here.patch.points.size() != 4) continue;
    ++patches;
    const auto expect_same = [&](const Contact& other, double by, double allowed) {
      EXPECT_LT((other.patch.normal - here.patch.normal).norm(), 1e-9);
      EXPECT_NEAR(other.patch.area, here.patch.area * by * by, 0.02 * allowed * by * by);
      EXPECT_LT((centroid(other.patch) - by * centroid(here.patch)).norm(), allowed * by);
      const Vec3 u = any_orthogonal(here.patch.normal);
      EXPECT_NEAR(second_moment(other.patch, u, u), by * by * second_moment(here.patch, u, u),
                  0.02 * allowed * by * by);
    };
    expect_same(contact(cases::renamed(A, random), cases::renamed(B, random), X, 5e-4), 1.0, 1e-9);
    const Pose X_WA{cases::random_rotation(random), cases::random_unit(random) * 1000.0};
    expect_same(contact(A, B, relative_pose(X_WA, X_WA * X), 5e-4), 1.0, 1e-8);
    for (double by : {0.02, 200.0})
      expect_same(contact(cases::scaled(A, by), cases::scaled(B, by), {X.R, X.p * by}, 5e-4 * by), by, 1e-9);
  }
  EXPECT_GT(patches, cases::some_of(100));
}

/// Largest step of the patch's centroid while a prism rocks through flat against a box, by 3.4 degrees to
/// either side, in steps of `step` [rad], at a distance of half the tolerance.
double largest_jump(std::uint64_t seed, double step) {
  Random random(seed);
  const Polytope A = make_box({0.0125, 0.0125, 0.0125});
  const Polytope B = make_prism(6, 0.02, 0.02);
  const double tolerance = 1e-4;
  double worst = 0.0;
  for (int run = 0; run < (cases::kSlowness > 1 ? 1 : 12); ++run) {
    const double spin = random.uniform(-3, 3);
    const double offset = random.uniform(-0.01, 0.01);
    const double heading = random.uniform(-3, 3);
    const Vec3 axis(std::cos(heading), std::sin(heading), 0);
    PairCache cache;
    Vec3 last = Vec3::Zero();
    bool have = false;
    for (double tilt = -0.06; tilt <= 0.06; tilt += step) {
      Pose X{exp_rotation(axis * tilt) * exp_rotation(Vec3(0, 0, spin)), {offset, 0.003, -0.03}};
      X.p.z() += closest_features(A, B, X, cache).distance - 5e-5;
      const PairDistance closest = closest_features(A, B, X, cache);
      Manifold patch;
      contact_manifold(A, B, X, closest, tolerance, patch);
      if (patch.points.empty()) return INFINITY;
      const Vec3 now = centroid(patch);
      if (have) worst = std::max(worst, (now - last).norm());
      last = now;
      have = true;
    }
  }
  return worst;
}

/// No jump: with finer steps the largest one shrinks in proportion. (It is not small by itself: with a gap of
/// 50 um the normal turns by 3 mrad while two edges slide past each other by 0.2 um.)
TEST(Manifold, CentroidMovesContinuously) {
  const std::uint64_t seed = 33;
  const double coarse = largest_jump(seed, cases::kSlowness > 1 ? 4e-4 : 2e-5);
  const double fine = cases::kSlowness > 1 ? 0.0 : largest_jump(seed, 1e-6);
  std::printf("  seed %llu: largest step of the centroid %.3g mm at 20 microradians, %.3g mm at 1\n",
              static_cast<unsigned long long>(seed), coarse * 1e3, fine * 1e3);
  EXPECT_LT(coarse, cases::kSlowness > 1 ? 1.0 : 1e-3);
  EXPECT_LT(fine, 0.25 * coarse);
}

TEST(Manifold, NeverEmptyBelowTheTolerance) {
  const std::uint64_t seed = 34;
  Random random(seed);
  const auto shapes = cases::shapes(random, true);
  const int poses = cases::full() ? 1000000 : cases::some_of(20000);
  int patches = 0;
  for (int i = 0; i < poses; ++i) {
    const cases::Shape& a = shapes[std::size_t(random.index(int(shapes.size())))];
    const cases::Shape& b = shapes[std::size_t(random.index(int(shapes.size())))];
    const Pose X =
        cases::make_pose(random, a.polytope, b.polytope, cases::Making(i % int(cases::Making::kCount)));
    const double size = std::max(a.polytope.extent.size, b.polytope.extent.size);
    const Contact c = contact(a.polytope, b.polytope, X, 0.01 * size);
    if (c.closest.distance >= 0.01 * size) {
      EXPECT_TRUE(c.patch.points.empty());
      continue;
    }
    ++patches;
    SCOPED_TRACE(a.name + " / " + b.name + ", seed " + std::to_string(seed) + ", case " + std::to_string(i) +
                 " " + cases::describe(X));
    ASSERT_FALSE(c.patch.points.empty());
    double weight = 0.0;
    for (const ContactPoint& p : c.patch.points) {
      weight += p.weight;
      EXPECT_TRUE(p.p_a.allFinite() && p.p_b.allFinite());
      EXPECT_NEAR(p.distance, c.patch.normal.dot(p.p_a - p.p_b), 1e-9 * size);
      // Quadrature points stay over the patch, so near both pieces.
      EXPECT_LT((p.p_a - a.polytope.extent.center).norm(), a.polytope.extent.radius * 1.3 + 0.02 * size);
      EXPECT_LT((p.p_b - X * b.polytope.extent.center).norm(), b.polytope.extent.radius * 1.3 + 0.02 * size);
    }
    EXPECT_NEAR(weight, 1.0, 1e-14);
  }
  EXPECT_GT(patches, poses / 4);
}

}  // namespace
}  // namespace tactum
