#include "tactum/collision/closest_features.h"

#include <gtest/gtest.h>

#include "collision/cases.h"
#include "oracles/exhaustive.h"
#include "tactum/base/tolerances.h"
#include "tactum/collision/penetration.h"

namespace tactum {
namespace {

using cases::Making;

struct Tally {
  int wrong = 0;
  int uncertified = 0;
  int fallback = 0;
  int overlapping = 0;
  int total = 0;
};

void report(const Tally& tally, std::uint64_t seed) {
  std::printf("  seed %llu: %d poses, %d overlapping, %d answered by a fallback, %d uncertified, %d wrong\n",
              static_cast<unsigned long long>(seed), tally.total, tally.overlapping, tally.fallback,
              tally.uncertified, tally.wrong);
}

void complain(Tally& tally, const cases::Shape& a, const cases::Shape& b, const Pose& X, int making,
              const PairDistance& answer, const std::string& why) {
  ++tally.wrong;
  if (tally.wrong <= 10)
    ADD_FAILURE() << a.name << " / " << b.name << ", making " << making << ", distance " << answer.distance
                  << ": " << why << " " << cases::describe(X);
}

TEST(ClosestFeatures, AgreesWithEveryPairOfFeaturesOnSmallShapes) {
  const std::uint64_t seed = 20261;
  Random random(seed);
  const auto shapes = cases::shapes(random, false);
  const int poses = cases::full() ? 1000000 : 30000;
  Tally tally;
  for (int i = 0; i < poses; ++i) {
    const cases::Shape& a = shapes[std::size_t(random.index(int(shapes.size())))];
    const cases::Shape& b = shapes[std::size_t(random.index(int(shapes.size())))];
    const int making = i % int(Making::kCount);
    const Pose X = cases::make_pose(random, a.polytope, b.polytope, Making(making));
    const double tolerance = 2.0 * tolerances::kCertificate * std::max(a.polytope.size, b.polytope.size);
    PairCache cache;
    const PairDistance answer = closest_features(a.polytope, b.polytope, X, cache);
    ++tally.total;
    tally.uncertified += !answer.certified();
    tally.fallback += answer.stop == Stop::kFallback;
    std::string why = oracle::complaint(a.polytope, b.polytope, X, answer, tolerance);
    if (answer.distance < -tolerance) {
      ++tally.overlapping;
      const double axes = double(oracle::axes_separation(a.polytope, b.polytope, X));
      if (std::abs(axes - answer.distance) > tolerance) why += "depth should be " + std::to_string(axes);
    } else if (i % 8 == 0 && answer.distance > tolerance) {
      const double features = double(oracle::feature_distance(a.polytope, b.polytope, X));
      if (std::abs(features - answer.distance) > tolerance) why += "features say " + std::to_string(features);
    }
    if (!why.empty()) complain(tally, a, b, X, making, answer, why);
  }
  report(tally, seed);
}

TEST(ClosestFeatures, LargeShapesProveThemselves) {
  const std::uint64_t seed = 20262;
  Random random(seed);
  const auto shapes = cases::shapes(random, true);
  const int poses = cases::full() ? 300000 : 6000;
  Tally tally;
  for (int i = 0; i < poses; ++i) {
    const cases::Shape& a = shapes[std::size_t(random.index(int(shapes.size())))];
    const cases::Shape& b = shapes[std::size_t(int(shapes.size()) - 1 - random.index(5))];
    const int making = i % int(Making::kCount);
    const Pose X = cases::make_pose(random, a.polytope, b.polytope, Making(making));
    const double tolerance = 2.0 * tolerances::kCertificate * std::max(a.polytope.size, b.polytope.size);
    PairCache cache;
    const PairDistance answer = closest_features(a.polytope, b.polytope, X, cache);
    ++tally.total;
    tally.uncertified += !answer.certified();
    tally.fallback += answer.stop == Stop::kFallback;
    std::string why = oracle::complaint(a.polytope, b.polytope, X, answer, tolerance);
    if (answer.distance < -tolerance) {
      ++tally.overlapping;
      if (i % 16 == 0 && !oracle::surely_overlap(a.polytope, b.polytope, X, 0.0L))
        why += "they do not overlap; ";
    }
    if (!why.empty()) complain(tally, a, b, X, making, answer, why);
  }
  report(tally, seed);
}

}  // namespace
}  // namespace tactum
