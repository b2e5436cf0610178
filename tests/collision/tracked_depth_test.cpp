/// The depth under a hand's motion: how often a tracked answer is not the global minimum, and what renaming,
/// swapping, moving and scaling change.

#include <gtest/gtest.h>

#include <algorithm>

#include "collision/cases.h"
#include "tactum/collision/penetration.h"

namespace tactum {
namespace {

struct Count {
  int frames = 0, missed = 0;
  double worst = 0.0;  ///< [m]
};

/// A hand at 1 kHz: 0.1-0.5 mm and 1-3 mrad a frame, in another direction every 60 frames.
struct Hand {
  Random& random;
  Vec3 v = Vec3::Zero();  ///< of the piece's center [m a frame]
  Vec3 w = Vec3::Zero();  ///< [rad a frame]

  void move(const Polytope& B, int frame, Pose& X) {
    if (frame % 60 == 0) {
      v = cases::random_unit(random) * random.uniform(1e-4, 5e-4);
      w = cases::random_unit(random) * random.uniform(1e-3, 3e-3);
    }
    const Vec3 center = X * B.extent.center + v;
    X.R = renormalized({exp_rotation(w) * X.R, Vec3::Zero()}).R;
    X.p = center - X.R * B.extent.center;
  }
};

/// B turned at random, its center beside A's by 0.3 radii; then drawn back until it is `depth` deep [m].
Pose touch(const Polytope& A, const Polytope& B, Random& random, double depth) {
  Pose X{cases::random_rotation(random), Vec3::Zero()};
  X.p = A.extent.center - X.R * B.extent.center +
        cases::random_unit(random) * 0.3 * std::min(A.extent.radius, B.extent.radius);
  const PairDistance inside = penetration_exhaustive(A, B, X);
  X.p += inside.normal * (inside.distance + depth);
  return X;
}

/// From first touch; the depth is kept within `most` [m]. Every `stride`-th frame is compared with every
/// facet of the Minkowski difference.
Count track(const Polytope& A, const Polytope& B, std::uint64_t seed, int frames, int stride, double most) {
  Random random(seed);
  Count count;
  Pose X{cases::random_rotation(random), Vec3::Zero()};
  Hand hand{random};
  PairCache cache;
  for (int i = 0; i < frames; ++i) {
    if (i % 500 == 0) {
      X = touch(A, B, random, 1e-3 * most);
      cache = {};
    }
    hand.move(B, i, X);
    const PairDistance tracked = penetration_depth(A, B, X, cache);
    if (-tracked.distance > most)
      X.p -= tracked.normal * (-tracked.distance - 0.95 * most);
    else if (tracked.distance > 0.0)
      X.p += tracked.normal * (tracked.distance + 0.05 * most);
    if (i % stride != 0 || tracked.distance > 0.0) continue;
    PairCache again = cache;
    const PairDistance now = penetration_depth(A, B, X, again);
    const double least = penetration_exhaustive(A, B, X).distance;
    const double size = std::max(A.extent.size, B.extent.size);
    EXPECT_LE(now.distance, least + 1e-9 * size) << "deeper than the least depth is no depth";
    ++count.frames;
    count.missed += now.distance < least - 1e-9 * size;
    count.worst = std::max(count.worst, least - now.distance);
  }
  return count;
}

TEST(TrackedDepth, MissesFewGlobalMinimaUnderAHandsMotion) {
  const std::uint64_t seed = 61;
  Random random(seed);
  const Polytope box = make_box({0.04, 0.05, 0.06});
  const Polytope prism = make_prism(64, 0.04, 0.05);
  const Polytope hull_30 = cases::random_hull(random, 30, {0.04, 0.05, 0.06});
  const Polytope hull_150 = cases::random_hull(random, 150, {0.04, 0.05, 0.06});
  const Polytope sphere_42 = make_icosphere(1, 0.05);
  const Polytope sphere_162 = make_icosphere(2, 0.05);
  const Polytope sphere_642 = make_icosphere(3, 0.05);
  const Polytope needle = make_box({0.001, 0.001, 0.05});
  const Polytope plate = make_box({0.05, 0.05, 0.0005});
  struct Pair {
    const char* name;
    const Polytope *a, *b;
    int stride;
    double most;  ///< [m]
    bool compact;
  };
  const std::vector<Pair> pairs = {{"boxes", &box, &box, 1, 5e-3, true},
                                   {"box, hull of 30", &box, &hull_30, 1, 5e-3, true},
                                   {"hulls of 30", &hull_30, &hull_30, 2, 5e-3, true},
                                   {"box, 64-prism", &box, &prism, 2, 5e-3, true},
                                   {"64-prisms", &prism, &prism, 16, 5e-3, true},
                                   {"box, sphere of 162", &box, &sphere_162, 4, 5e-3, true},
                                   {"spheres of 42", &sphere_42, &sphere_42, 8, 5e-3, true},
                                   {"spheres of 162", &sphere_162, &sphere_162, 64, 5e-3, true},
                                   {"hulls of 150", &hull_150, &hull_150, 64, 5e-3, true},
                                   {"spheres of 642", &sphere_642, &sphere_642, 1000, 5e-3, true},
                                   {"needle 50:1, box", &needle, &box, 1, 1e-4, false},
                                   {"needles", &needle, &needle, 1, 1e-4, false},
                                   {"plate 100:1, box", &plate, &box, 1, 1e-4, false},
                                   {"plates", &plate, &plate, 1, 1e-4, false}};
  Count compact;
  std::uint64_t k = 0;
  for (const Pair& pair : pairs) {
    const int frames = cases::full() ? 100000 : std::max(10, cases::some_of(4000));
    const Count count = track(*pair.a, *pair.b, seed + ++k, frames, pair.stride, pair.most);
    std::printf("  %-22s %6d frames compared, %4d missed (%.3f %%), by %.3g um at most\n", pair.name,
                count.frames, count.missed, 100.0 * count.missed / std::max(1, count.frames),
                count.worst * 1e6);
    if (!pair.compact) continue;
    compact.frames += count.frames;
    compact.missed += count.missed;
  }
  EXPECT_GT(compact.frames, cases::some_of(9000));
  EXPECT_LE(compact.missed, 0.003 * compact.frames) << "seed " << seed;
}

/// Kept 1 um deep for 300 frames, as a stiff contact is, then pushed on by 0.1 mm a frame up to `most` [m]:
/// the search beside the tracked minimum must have covered far more than a depth of almost nothing.
Count push_on(const Polytope& A, const Polytope& B, std::uint64_t seed, int rounds, double most) {
  constexpr double kGraze = 1e-6;
  constexpr double kPush = 1e-4;
  constexpr int kResting = 300;
  constexpr int kPushed = 60;
  Random random(seed);
  Count count;
  for (int round = 0; round < rounds; ++round) {
    Pose X = touch(A, B, random, kGraze);
    Hand hand{random};
    PairCache cache;
    const auto without_a_trace = [&] {
      PairCache same = cache;
      return penetration_depth(A, B, X, same);
    };
    for (int i = 0; i < kResting + kPushed; ++i) {
      hand.move(B, i, X);
      const bool resting = i < kResting;
      for (int again = 0; resting && again < 4; ++again) {
        const PairDistance now = without_a_trace();
        X.p += now.normal * (now.distance + kGraze);
      }
      if (const PairDistance now = without_a_trace(); !resting && -now.distance < most)
        X.p += now.normal * kPush;
      const PairDistance tracked = penetration_depth(A, B, X, cache);
      if (resting || tracked.distance > 0.0) continue;
      const double least = penetration_exhaustive(A, B, X).distance;
      if (least >= 0.0) continue;
      ++count.frames;
      count.missed += tracked.distance < least - 1e-9 * std::max(A.extent.size, B.extent.size);
      count.worst = std::max(count.worst, least - tracked.distance);
    }
  }
  return count;
}

TEST(TrackedDepth, AGrazeDoesNotNarrowTheSearch) {
  const Polytope box = make_box({0.04, 0.05, 0.06});
  const Polytope bar = make_box({0.005, 0.005, 0.05});
  const Polytope needle = make_box({0.001, 0.001, 0.05});
  const Polytope plate = make_box({0.05, 0.05, 0.0005});
  struct Pair {
    const char* name;
    const Polytope *a, *b;
    double most;  ///< [m]
    double may_miss;
  };
  const std::uint64_t seed = 63;
  for (const Pair& pair :
       {Pair{"boxes", &box, &box, 5e-3, 0.003}, Pair{"bars 10:1", &bar, &bar, 8e-4, 0.01},
        Pair{"plates", &plate, &plate, 8e-4, 0.004}, Pair{"needle, plate", &needle, &plate, 8e-4, 0.012},
        Pair{"needles", &needle, &needle, 8e-4, 0.04}}) {
    const int rounds = cases::full() ? 4000 : std::max(60, cases::some_of(400));
    const Count count = push_on(*pair.a, *pair.b, seed, rounds, pair.most);
    std::printf("  %-14s %6d frames compared, %4d missed (%.3f %%), by %.3g um at most\n", pair.name,
                count.frames, count.missed, 100.0 * count.missed / std::max(1, count.frames),
                count.worst * 1e6);
    EXPECT_GT(count.frames, 20 * rounds) << pair.name;
    EXPECT_LE(count.missed, pair.may_miss * count.frames) << pair.name << ", seed " << seed;
  }
}

/// Cold, where small pieces give the global minimum: 2e-9 of the size, and 1e-12 m a kilometre away.
TEST(TrackedDepth, NamesOrderPlaceAndScaleDoNotMatter) {
  const std::uint64_t seed = 62;
  Random random(seed);
  const auto shapes = cases::shapes(random, false);
  const auto depth = [](const Polytope& A, const Polytope& B, const Pose& X) {
    PairCache cache;
    return penetration_depth(A, B, X, cache).distance;
  };
  for (int i = 0; i < cases::some_of(1500); ++i) {
    const Polytope& A = shapes[std::size_t(random.index(int(shapes.size())))].polytope;
    const Polytope& B = shapes[std::size_t(random.index(int(shapes.size())))].polytope;
    if (A.flat || B.flat) continue;
    Pose X{cases::random_rotation(random), Vec3::Zero()};
    X.p = A.extent.center - X.R * B.extent.center +
          cases::random_unit(random) * 0.5 * std::min(A.extent.radius, B.extent.radius);
    const double size = std::max(A.extent.size, B.extent.size);
    const double d = depth(A, B, X);
    if (d >= 0.0) continue;
    SCOPED_TRACE("seed " + std::to_string(seed) + ", case " + std::to_string(i) + " " + cases::describe(X));
    EXPECT_NEAR(depth(B, A, X.inverse()), d, 2e-9 * size);
    EXPECT_NEAR(depth(cases::renamed(A, random), cases::renamed(B, random), X), d, 2e-9 * size);
    const Pose X_WA{cases::random_rotation(random), cases::random_vector(random, 1000.0)};
    EXPECT_NEAR(depth(A, B, relative_pose(X_WA, X_WA * X)), d, 1e-11);
    for (double by : {1e-3 / size, 10.0 / size})
      EXPECT_NEAR(depth(cases::scaled(A, by), cases::scaled(B, by), {X.R, X.p * by}), d * by,
                  2e-9 * size * by);
  }
}

}  // namespace
}  // namespace tactum
