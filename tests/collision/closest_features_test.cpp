#include "tactum/collision/closest_features.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "collision/cases.h"
#include "oracles/exhaustive.h"
#include "tactum/base/tolerances.h"
#include "tactum/collision/penetration.h"

namespace tactum {
namespace {

using cases::Making;

struct Tally {
  int wrong = 0;
  int most_steps = 0;
  int uncertified = 0;
  int fallback = 0;
  int overlapping = 0;
  int total = 0;
};

void report(const Tally& tally, std::uint64_t seed) {
  std::printf(
      "  seed %llu: %d poses, %d overlapping, %d answered by a fallback, %d uncertified, %d wrong, "
      "at most %d steps\n",
      static_cast<unsigned long long>(seed), tally.total, tally.overlapping, tally.fallback,
      tally.uncertified, tally.wrong, tally.most_steps);
}

bool nearly_touching(const Polytope& A, const Polytope& B, const PairDistance& answer) {
  return std::abs(answer.distance) < 1e-6 * std::max(A.size, B.size);
}

/// Below a gap of 1e-6 of the size an answer need not be certified, but then its doubt must hold.
std::string complaint_about(const Polytope& A, const Polytope& B, const Pose& X, const PairDistance& answer,
                            double tolerance) {
  if (answer.certified() || !nearly_touching(A, B, answer))
    return oracle::complaint(A, B, X, answer, tolerance);
  if (!std::isfinite(answer.doubt)) return {};
  const long double least = answer.distance - answer.doubt - 1e-6 * tolerance;
  return oracle::support_gap(A, B, X, answer.normal) < least ? "the doubt told is too small" : "";
}

/// Edges parallel to 1e-8 make no axis; nearly touching flat pieces then miss the shallowest by as much.
double depth_tolerance(const Polytope& A, const Polytope& B, const PairDistance& answer, double tolerance) {
  return nearly_touching(A, B, answer) ? 10.0 * tolerance : tolerance;
}

void complain(Tally& tally, const cases::Shape& a, const cases::Shape& b, const Pose& X, int making,
              const PairDistance& answer, const std::string& why) {
  ++tally.wrong;
  if (tally.wrong <= 10)
    ADD_FAILURE() << a.name << " / " << b.name << ", making " << making << ", distance " << answer.distance
                  << " (doubt " << answer.doubt << ", stop " << int(answer.stop) << ", features "
                  << int(answer.a.kind) << ' ' << answer.a.index << ", " << int(answer.b.kind) << ' '
                  << answer.b.index << "): " << why << " " << cases::describe(X);
}

/// Boxes alike and turned, flush as in a grid, prisms, needles, plates, triangles; features exactly parallel
/// and off by 1e-16 to 1e-2 rad; gaps from exact touch on. In parts, so that ten million poses can run side
/// by side.
class Adversarial : public ::testing::TestWithParam<int> {};

TEST_P(Adversarial, AgreesWithEveryPairOfFeaturesOnSmallShapes) {
  const std::uint64_t seed = 20261 + 1000 * static_cast<std::uint64_t>(GetParam());
  Random random(seed);
  const auto shapes = cases::shapes(random, false);
  const int poses = cases::full() ? 1000000 : cases::some_of(4000);
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
    tally.most_steps = std::max(tally.most_steps, answer.steps);
    tally.uncertified += !answer.certified();
    tally.fallback += answer.stop == Stop::kFallback;
    std::string why = complaint_about(a.polytope, b.polytope, X, answer, tolerance);
    if (answer.distance < -tolerance) {
      ++tally.overlapping;
      const double axes = double(oracle::axes_separation(a.polytope, b.polytope, X));
      if (std::abs(axes - answer.distance) > depth_tolerance(a.polytope, b.polytope, answer, tolerance))
        why += "depth is off by " + std::to_string((answer.distance - axes) * 1e12) + " pm";
    } else if (i % 8 == 0 && answer.distance > tolerance) {
      const double features = double(oracle::feature_distance(a.polytope, b.polytope, X));
      if (std::abs(features - answer.distance) > tolerance) why += "features say " + std::to_string(features);
    }
    if (!why.empty()) complain(tally, a, b, X, making, answer, why);
  }
  report(tally, seed);
}

INSTANTIATE_TEST_SUITE_P(Part, Adversarial, ::testing::Range(0, 10));

TEST(ClosestFeatures, LargeShapesProveThemselves) {
  const std::uint64_t seed = 20262;
  Random random(seed);
  const auto shapes = cases::shapes(random, true);
  const int poses = cases::full() ? 300000 : cases::some_of(6000);
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
    tally.most_steps = std::max(tally.most_steps, answer.steps);
    tally.uncertified += !answer.certified();
    tally.fallback += answer.stop == Stop::kFallback;
    std::string why = complaint_about(a.polytope, b.polytope, X, answer, tolerance);
    if (answer.distance < -tolerance) {
      ++tally.overlapping;
      if (i % 16 == 0 && !oracle::surely_overlap(a.polytope, b.polytope, X, 0.0L))
        why += "they do not overlap; ";
    }
    if (!why.empty()) complain(tally, a, b, X, making, answer, why);
  }
  report(tally, seed);
}

/// A pose, its two pieces and what must hold for every answer about them.
struct Case {
  const cases::Shape& a;
  const cases::Shape& b;
  Pose X_AB;
  double size;
};

/// Calls check(case) for `poses` poses of all makings, from nearly touching to far apart and overlapping.
template <class Check>
void for_cases(std::uint64_t seed, int poses, const Check& check) {
  Random random(seed);
  const auto shapes = cases::shapes(random, true);
  for (int i = 0; i < cases::some_of(poses); ++i) {
    const cases::Shape& a = shapes[std::size_t(random.index(int(shapes.size())))];
    const cases::Shape& b = shapes[std::size_t(random.index(int(shapes.size())))];
    const Pose X = cases::make_pose(random, a.polytope, b.polytope, Making(i % int(Making::kCount)));
    SCOPED_TRACE(a.name + " / " + b.name + ", seed " + std::to_string(seed) + ", case " + std::to_string(i) +
                 " " + cases::describe(X));
    check(random, Case{a, b, X, std::max(a.polytope.size, b.polytope.size)});
  }
}

PairDistance cold(const Polytope& A, const Polytope& B, const Pose& X_AB) {
  PairCache cache;
  return closest_features(A, B, X_AB, cache);
}

bool small(const Case& c) { return c.a.polytope.edges.size() * c.b.polytope.edges.size() <= 4096; }

TEST(ClosestFeatures, SwappingAAndBKeepsTheDistance) {
  for_cases(20263, 20000, [](Random&, const Case& c) {
    const PairDistance ab = cold(c.a.polytope, c.b.polytope, c.X_AB);
    const PairDistance ba = cold(c.b.polytope, c.a.polytope, c.X_AB.inverse());
    if (ab.distance < 0.0 && !small(c)) return;  // a local minimum may be another from the other side
    EXPECT_NEAR(ab.distance, ba.distance, 4e-9 * c.size);
    // Away from touching the points' line is the normal, and there is one nearest distance vector.
    if (ab.distance > 1e-3 * c.size) {
      EXPECT_LT((c.X_AB.R * ba.normal + ab.normal).norm(), 1e-3);
    }
  });
}

TEST(ClosestFeatures, MovingTheWorldChangesNothing) {
  for_cases(20264, 20000, [](Random& random, const Case& c) {
    if (!small(c)) return;
    const Pose X_WA{cases::random_rotation(random), cases::random_vector(random, 0.3)};
    const Pose X_WB = X_WA * c.X_AB;
    const PairDistance here = cold(c.a.polytope, c.b.polytope, c.X_AB);
    const PairDistance there = cold(c.a.polytope, c.b.polytope, relative_pose(X_WA, X_WB));
    EXPECT_NEAR(here.distance, there.distance, 4e-9 * c.size);
  });
}

/// A thousand kilometres of world lose 1e-10 m of the poses, and so of the distance; one loses 1e-13.
TEST(ClosestFeatures, FarFromTheWorldsOriginOnlyTheRoundingOfThePosesIsLost) {
  for_cases(20268, 20000, [](Random& random, const Case& c) {
    if (!small(c)) return;
    const Pose X_WA{cases::random_rotation(random), cases::random_unit(random) * 1e3};
    const Pose X_WB = X_WA * c.X_AB;
    const PairDistance here = cold(c.a.polytope, c.b.polytope, c.X_AB);
    const PairDistance there = cold(c.a.polytope, c.b.polytope, relative_pose(X_WA, X_WB));
    EXPECT_TRUE(there.certified());
    EXPECT_NEAR(here.distance, there.distance, 1e-12 + 4e-9 * c.size);
  });
}

TEST(ClosestFeatures, TheOrderOfTheVerticesDoesNotMatter) {
  for_cases(20269, 1000, [&](Random& random, const Case& c) {
    if (!small(c)) return;
    const Polytope A = cases::renamed(c.a.polytope, random);
    const Polytope B = cases::renamed(c.b.polytope, random);
    const PairDistance one = cold(c.a.polytope, c.b.polytope, c.X_AB);
    const PairDistance other = cold(A, B, c.X_AB);
    EXPECT_TRUE(other.certified());
    EXPECT_NEAR(one.distance, other.distance, 4e-9 * c.size);
  });
}

TEST(ClosestFeatures, ScalesWithThePieces) {
  for_cases(20265, 600, [&](Random&, const Case& c) {
    if (!small(c)) return;
    for (double by : {1e-3, 1e3}) {
      const Pose X{c.X_AB.R, c.X_AB.p * by};
      const PairDistance one = cold(c.a.polytope, c.b.polytope, c.X_AB);
      const PairDistance other = cold(cases::scaled(c.a.polytope, by), cases::scaled(c.b.polytope, by), X);
      EXPECT_NEAR(one.distance * by, other.distance, 4e-9 * c.size * by);
      EXPECT_TRUE(other.certified());
    }
  });
}

/// The cache may hold anything: features of another pair, of another pose, or none. The answer is the same.
TEST(ClosestFeatures, TheCacheOnlySavesTime) {
  for_cases(20266, 20000, [](Random& random, const Case& c) {
    if (!small(c)) return;
    PairCache stale;
    stale.a = {FeatureKind(random.index(3)), random.index(40) - 2};
    stale.b = {FeatureKind(random.index(3)), random.index(40) - 2};
    const PairDistance fresh = cold(c.a.polytope, c.b.polytope, c.X_AB);
    const PairDistance answer = closest_features(c.a.polytope, c.b.polytope, c.X_AB, stale);
    EXPECT_TRUE(answer.certified());
    EXPECT_NEAR(answer.distance, fresh.distance, 4e-9 * c.size);
    const PairDistance again = closest_features(c.a.polytope, c.b.polytope, c.X_AB, stale);
    EXPECT_TRUE(again.certified());
    EXPECT_NEAR(again.distance, fresh.distance, 4e-9 * c.size);
  });
}

/// Tracked pairs: the next answer comes from the last one's features, every one certified.
TEST(ClosestFeatures, TrackedMotionIsCertifiedInFewSteps) {
  Random random(20267);
  const auto shapes = cases::shapes(random, true);
  long steps = 0;
  long frames = 0;
  for (int run = 0; run < cases::some_of(200); ++run) {
    const Polytope& A = shapes[std::size_t(random.index(int(shapes.size())))].polytope;
    const Polytope& B = shapes[std::size_t(random.index(int(shapes.size())))].polytope;
    Pose X{cases::random_rotation(random), Vec3::Zero()};
    X.p = A.center - X.R * B.center + cases::random_unit(random) * (A.radius + B.radius) * 1.05;
    const Vec3 v = cases::random_vector(random, 0.05);
    const Vec3 w = cases::random_vector(random, 1.0);
    PairCache cache;
    for (int frame = 0; frame < 200; ++frame) {
      X = advanced(X, {v, w}, 1e-3);
      const PairDistance x = closest_features(A, B, X, cache);
      ASSERT_EQ(oracle::complaint(A, B, X, x, 2e-9 * std::max(A.size, B.size)), "")
          << "run " << run << " frame " << frame;
      if (x.distance <= 0.0) break;
      steps += x.steps;
      ++frames;
    }
  }
  std::printf("  %ld tracked frames, %.2f feature pairs a frame\n", frames, double(steps) / double(frames));
  EXPECT_LT(double(steps), 1.5 * double(frames));
}

/// Two long edges at the angle where the walk changes from one way of telling them to the other, over each
/// other's ends and between, from touching to apart: both ways say the same, and neither sends it in circles.
TEST(ClosestFeatures, EdgesAreTheSameEitherWayTheyAreTold) {
  const Polytope A = make_prism(3, 0.01, 0.1);
  const Polytope B = make_prism(3, 0.01, 0.1);
  const double size = A.size;
  for (double sine : {0.05, 0.0999999999, 0.1, 0.1000000001, 0.2})
    for (double along : {0.0, 0.049, 0.05, 0.05 - 1e-15, 0.05 + 1e-15, 0.051})
      for (double gap : {0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3}) {
        const Polytope::Edge* edge = nullptr;
        for (const Polytope::Edge& e : A.edges)
          if (e.length > 0.09) edge = &e;
        ASSERT_NE(edge, nullptr);
        const Vec3 out =
            (A.faces[std::size_t(edge->left)].normal + A.faces[std::size_t(edge->right)].normal).normalized();
        const Vec3 middle = A.vertices[std::size_t(edge->tail)] + edge->direction * (0.5 * edge->length);
        // B turned over, its same edge facing A's across the gap, then turned by the angle.
        const Vec3 square = edge->direction.cross(out);
        const Mat3 over = exp_rotation(edge->direction * kPi);
        const Mat3 R = exp_rotation(out * std::asin(sine)) * over;
        const Pose X{R, middle + out * gap + edge->direction * along + square * 1e-4 - R * middle};
        PairCache cache;
        const PairDistance x = closest_features(A, B, X, cache);
        EXPECT_EQ(oracle::complaint(A, B, X, x, 2e-9 * size), "")
            << "sine " << sine << " along " << along << " gap " << gap;
        const PairDistance again = closest_features(A, B, X, cache);
        EXPECT_NEAR(again.distance, x.distance, 2e-9 * size);
        EXPECT_LE(again.steps, x.steps + 2);
      }
}

/// How far `point` is from the line of an edge of P, whose pose in the point's frame is X [m].
double off_line(const Polytope& P, int edge, const Pose& X, const Vec3& point) {
  const Polytope::Edge& e = P.edges[std::size_t(edge)];
  return (X.R * e.direction).cross(point - X * P.vertices[std::size_t(e.tail)]).norm();
}

/// Between edges that cross nothing is measured of what rounding leaves: the bound told must hold, of the
/// support planes in long double and of the points on their edges, at any angle and from any place.
TEST(ClosestFeatures, TheDoubtOfCrossingEdgesHolds) {
  Random random(20268);
  const auto shapes = cases::shapes(random, false);
  int crossing = 0;
  for (int pose = 0; pose < cases::some_of(200000); ++pose) {
    const Polytope& A = shapes[std::size_t(random.index(int(shapes.size())))].polytope;
    const Polytope& B = shapes[std::size_t(random.index(int(shapes.size())))].polytope;
    Pose X{cases::random_rotation(random), Vec3::Zero()};
    X.p = A.center - X.R * B.center + cases::random_unit(random) * (A.radius + B.radius);
    PairCache cache;
    const PairDistance x = closest_features(A, B, X, cache);
    if (x.stop != Stop::kCertified || x.distance <= 0.0) continue;
    if (x.a.kind != FeatureKind::kEdge || x.b.kind != FeatureKind::kEdge) continue;
    const Vec3 across =
        A.edges[std::size_t(x.a.index)].direction.cross(X.R * B.edges[std::size_t(x.b.index)].direction);
    if (across.norm() <= tolerances::kCrossingSine) continue;
    ++crossing;
    const double left = double(x.distance - oracle::support_gap(A, B, X, x.normal));
    ASSERT_LE(left, x.doubt) << cases::describe(X);
    ASSERT_LE((x.p_a - x.p_b - x.normal * x.distance).norm(), x.doubt);
    ASSERT_LE(off_line(A, x.a.index, {}, x.p_a), x.doubt + 1e-15 * A.size);
    ASSERT_LE(off_line(B, x.b.index, X, x.p_b), x.doubt + 1e-15 * (A.size + B.size));
  }
  std::printf("  %d pairs of crossing edges\n", crossing);
  EXPECT_GT(crossing, cases::some_of(200000) / 20);
}

/// A pose with a number that is none proves nothing, whatever was known before, stays within the pieces'
/// arrays, and is forgotten with the next good pose.
TEST(ClosestFeatures, OfAPoseThatIsNotFiniteNothingIsCertified) {
  Random random(20271);
  for (const cases::Shape& shape : cases::shapes(random, true)) {
    const Polytope& P = shape.polytope;
    SCOPED_TRACE(shape.name);
    for (const double apart : {2.5, 0.3, 0.02})
      for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()})
        for (int entry = 0; entry < 12; ++entry) {
          const Pose good{Mat3::Identity(), apart * P.size * Vec3(0.3, 0.8, 0.52)};
          Pose broken = good;
          (entry < 3 ? broken.p[entry] : broken.R(entry % 3, entry / 3 - 1)) = bad;
          PairCache cold;
          EXPECT_FALSE(closest_features(P, P, broken, cold).certified());
          PairCache tracked;
          closest_features(P, P, good, tracked);
          for (int frame = 0; frame < 8; ++frame)
            ASSERT_FALSE(closest_features(P, P, broken, tracked).certified()) << "entry " << entry;
          PairCache inside = tracked;
          for (int frame = 0; frame < 8; ++frame)
            ASSERT_FALSE(penetration_depth(P, P, broken, inside).certified()) << "entry " << entry;
          depth_along(P, P, broken, Vec3::UnitX());
          EXPECT_TRUE(closest_features(P, P, good, tracked).certified()) << "entry " << entry;
        }
  }
}

}  // namespace
}  // namespace tactum
