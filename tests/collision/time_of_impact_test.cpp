#include "tactum/collision/time_of_impact.h"

#include <gtest/gtest.h>

#include "collision/cases.h"
#include "tactum/base/tolerances.h"
#include "tactum/collision/closest_features.h"

namespace tactum {
namespace {

double distance_at(const Polytope& A, const Pose& X_WA, const Twist& V_WA, const Polytope& B,
                   const Pose& X_WB, const Twist& V_WB, double t, PairCache& cache) {
  return closest_features(A, B, relative_pose(advanced(X_WA, V_WA, t), advanced(X_WB, V_WB, t)), cache)
      .distance;
}

TEST(TimeOfImpact, StraightFlightOfBoxesIsExact) {
  const Polytope box = make_box({0.01, 0.01, 0.01});
  PairCache cache;
  const TimeOfImpact hit = time_of_impact(box, {}, {}, box, {Mat3::Identity(), {0.05, 0.002, 0}},
                                          {{-0.5, 0, 0}, Vec3::Zero()}, 1.0, 0.001, cache);
  EXPECT_EQ(hit.status, ImpactStatus::kHit);
  EXPECT_NEAR(hit.time, (0.03 - 0.001) / 0.5, 1e-7);
  EXPECT_LE(hit.steps, 3);
}

TEST(TimeOfImpact, SaysMissAndStartedInside) {
  const Polytope box = make_box({0.01, 0.01, 0.01});
  PairCache cache;
  const Pose beside{Mat3::Identity(), {0.05, 0, 0}};
  EXPECT_EQ(time_of_impact(box, {}, {}, box, beside, {{0.5, 0, 0}, Vec3::Zero()}, 1.0, 0.001, cache).status,
            ImpactStatus::kMiss);
  EXPECT_EQ(time_of_impact(box, {}, {}, box, beside, {{-0.5, 0, 0}, Vec3::Zero()}, 0.01, 0.001, cache).status,
            ImpactStatus::kMiss);
  const TimeOfImpact inside =
      time_of_impact(box, {}, {}, box, beside, {{-0.5, 0, 0}, Vec3::Zero()}, 1.0, 0.031, cache);
  EXPECT_EQ(inside.status, ImpactStatus::kStartedInside);
  EXPECT_EQ(inside.time, 0.0);
}

/// Spinning pieces: never past the contact (sampled finely before it), and near the target when the answer is
/// a hit.
TEST(TimeOfImpact, NeverOvershoots) {
  const std::uint64_t seed = 51;
  Random random(seed);
  const auto shapes = cases::shapes(random, true);
  const int runs = cases::full() ? 20000 : cases::some_of(1500);
  int hits = 0;
  int misses = 0;
  int bounded = 0;
  int steps = 0;
  for (int i = 0; i < runs; ++i) {
    const Polytope& A = shapes[std::size_t(random.index(int(shapes.size())))].polytope;
    const Polytope& B = shapes[std::size_t(random.index(int(shapes.size())))].polytope;
    const double size = std::max(A.extent.size, B.extent.size);
    const Mat3 R_WA = cases::random_rotation(random);
    const Mat3 R_WB = cases::random_rotation(random);
    const Pose X_WA{R_WA, cases::random_vector(random, 0.05)};
    const Vec3 away =
        cases::random_unit(random) * (A.extent.radius + B.extent.radius) * random.uniform(0.7, 1.5);
    const Pose X_WB{R_WB, X_WA.p + away};
    const Vec3 aim = away + cases::random_vector(random, 0.03);
    const Twist V_WA{aim * random.uniform(0.0, 2.0), cases::random_vector(random, 6.0)};
    const Twist V_WB{cases::random_vector(random, 0.05), cases::random_vector(random, 6.0)};
    const double target = 1e-4 * size;
    PairCache cache;
    const TimeOfImpact impact = time_of_impact(A, X_WA, V_WA, B, X_WB, V_WB, 1.0, target, cache);
    SCOPED_TRACE("seed " + std::to_string(seed) + ", case " + std::to_string(i));
    hits += impact.status == ImpactStatus::kHit;
    misses += impact.status == ImpactStatus::kMiss;
    bounded += impact.status == ImpactStatus::kBounded;
    steps += impact.steps;
    if (impact.status == ImpactStatus::kStartedInside) {
      EXPECT_LE(distance_at(A, X_WA, V_WA, B, X_WB, V_WB, 0.0, cache), target + 1e-9 * size);
      continue;
    }
    PairCache warm;
    for (int k = 0; k < 150; ++k)
      ASSERT_GT(distance_at(A, X_WA, V_WA, B, X_WB, V_WB, impact.time * k / 150, warm), target - 1e-9 * size);
    if (impact.status == ImpactStatus::kHit) {
      const double d = distance_at(A, X_WA, V_WA, B, X_WB, V_WB, impact.time, warm);
      ASSERT_LE(d, target + 1.01 * tolerances::kImpactGap * size);
      ASSERT_GE(d, target - 1e-9 * size);
    } else if (impact.status == ImpactStatus::kMiss) {
      ASSERT_EQ(impact.time, 1.0);
    }
  }
  std::printf("  seed %llu: %d hits, %d misses, %d out of steps of %d; %.1f steps each\n",
              static_cast<unsigned long long>(seed), hits, misses, bounded, runs, double(steps) / runs);
  EXPECT_GT(hits, runs / 20);
  EXPECT_GT(misses, runs / 20);
  EXPECT_LE(bounded, runs / 25);
}

/// Every shape against every other, needles and plates among them, against a dense referee: 2 000 samples of
/// the distance. No sample before the answer is below the target; a hit is within kImpactGap of the size of
/// the target, so it is early by no more than that gap takes to close; a miss has no sample below it at all.
TEST(TimeOfImpact, AgreesWithADenseRefereeForEveryPairOfShapes) {
  const std::uint64_t seed = 52;
  Random random(seed);
  const auto shapes = cases::shapes(random, true);
  const int samples = cases::full() ? 2000 : std::max(20, cases::some_of(200));
  int most_steps = 0;
  int hits = 0;
  for (const cases::Shape& a : shapes)
    for (const cases::Shape& b : shapes) {
      const Polytope& A = a.polytope;
      const Polytope& B = b.polytope;
      const double size = std::max(A.extent.size, B.extent.size);
      const Vec3 away = cases::random_unit(random) * 0.5 * (A.extent.size + B.extent.size);
      const Pose X_WA{cases::random_rotation(random), cases::random_vector(random, 0.02)};
      const Pose X_WB{cases::random_rotation(random), X_WA.p + away};
      const Vec3 w_A = cases::random_unit(random) * random.uniform(0.0, 3.0);
      const Vec3 w_B = cases::random_unit(random) * random.uniform(0.0, 3.0);
      const Twist V_WA{0.5 * away, w_A};
      const Twist V_WB{-0.7 * away, w_B};
      const double target = 1e-4 * size;
      PairCache cache;
      const TimeOfImpact impact = time_of_impact(A, X_WA, V_WA, B, X_WB, V_WB, 1.0, target, cache);
      SCOPED_TRACE(a.name + " / " + b.name + ", seed " + std::to_string(seed));
      most_steps = std::max(most_steps, impact.steps);
      EXPECT_LE(impact.steps, 64);
      if (impact.status == ImpactStatus::kStartedInside) continue;
      PairCache warm;
      const auto at = [&](double t) { return distance_at(A, X_WA, V_WA, B, X_WB, V_WB, t, warm); };
      for (int k = 0; k < samples; ++k) ASSERT_GT(at(impact.time * k / samples), target - 1e-9 * size);
      if (impact.status != ImpactStatus::kHit) continue;
      ++hits;
      ASSERT_NEAR(at(impact.time), target, 1.01 * tolerances::kImpactGap * size);
    }
  std::printf("  seed %llu: %d hits, at most %d steps\n", static_cast<unsigned long long>(seed), hits,
              most_steps);
  EXPECT_GT(hits, 50);
}

}  // namespace
}  // namespace tactum
