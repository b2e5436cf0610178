#include "tactum/collision/closest_features.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "collision/cases.h"
#include "oracles/exhaustive.h"
#include "tactum/base/tolerances.h"
#include "tactum/collision/penetration.h"
#include "tactum/collision/time_of_impact.h"
#include "tactum/geometry/hull.h"

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
  return std::abs(answer.distance) < 1e-6 * std::max(A.extent.size, B.extent.size);
}

/// Below a gap of 1e-6 of the size an answer need not be certified, but then its error bound must hold.
std::string complaint_about(const Polytope& A, const Polytope& B, const Pose& X, const PairDistance& answer,
                            double tolerance) {
  if (answer.certified() || !nearly_touching(A, B, answer))
    return oracle::complaint(A, B, X, answer, tolerance);
  if (!std::isfinite(answer.error_bound)) return {};
  const long double least = answer.distance - answer.error_bound - 1e-6 * tolerance;
  return oracle::support_gap(A, B, X, answer.normal) < least ? "the error bound told is too small" : "";
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
                  << " (error bound " << answer.error_bound << ", stop " << int(answer.stop) << ", features "
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
    const double tolerance =
        2.0 * tolerances::kCertificate * std::max(a.polytope.extent.size, b.polytope.extent.size);
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
    const double tolerance =
        2.0 * tolerances::kCertificate * std::max(a.polytope.extent.size, b.polytope.extent.size);
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

/// A pose, its two pieces and the conditions of every answer about them.
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
    check(random, Case{a, b, X, std::max(a.polytope.extent.size, b.polytope.extent.size)});
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
    X.p = A.extent.center - X.R * B.extent.center +
          cases::random_unit(random) * (A.extent.radius + B.extent.radius) * 1.05;
    const Vec3 v = cases::random_vector(random, 0.05);
    const Vec3 w = cases::random_vector(random, 1.0);
    PairCache cache;
    for (int frame = 0; frame < 200; ++frame) {
      X = advanced(X, {v, w}, 1e-3);
      const PairDistance x = closest_features(A, B, X, cache);
      ASSERT_EQ(oracle::complaint(A, B, X, x, 2e-9 * std::max(A.extent.size, B.extent.size)), "")
          << "run " << run << " frame " << frame;
      if (x.distance <= 0.0) break;
      steps += x.steps;
      ++frames;
    }
  }
  std::printf("  %ld tracked frames, %.2f feature pairs a frame\n", frames, double(steps) / double(frames));
  EXPECT_LT(double(steps), 1.5 * double(frames));
}

/// Two long edges at the angle where the walk changes from one formula for them to the other, over each
/// other's ends and between, from touching to apart: both formulas agree, and neither makes the walk cycle.
TEST(ClosestFeatures, EdgesAreTheSameEitherWayTheyAreTold) {
  const Polytope A = make_prism(3, 0.01, 0.1);
  const Polytope B = make_prism(3, 0.01, 0.1);
  const double size = A.extent.size;
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

/// Between edges that cross no rounding error is measured: the stated bound must hold, of the support planes
/// in long double and of the points on their edges, at any angle and from any place.
TEST(ClosestFeatures, TheErrorBoundOfCrossingEdgesHolds) {
  Random random(20268);
  const auto shapes = cases::shapes(random, false);
  int crossing = 0;
  for (int pose = 0; pose < cases::some_of(200000); ++pose) {
    const Polytope& A = shapes[std::size_t(random.index(int(shapes.size())))].polytope;
    const Polytope& B = shapes[std::size_t(random.index(int(shapes.size())))].polytope;
    Pose X{cases::random_rotation(random), Vec3::Zero()};
    X.p = A.extent.center - X.R * B.extent.center +
          cases::random_unit(random) * (A.extent.radius + B.extent.radius);
    PairCache cache;
    const PairDistance x = closest_features(A, B, X, cache);
    if (x.stop != Stop::kCertified || x.distance <= 0.0) continue;
    if (x.a.kind != FeatureKind::kEdge || x.b.kind != FeatureKind::kEdge) continue;
    const Vec3 across =
        A.edges[std::size_t(x.a.index)].direction.cross(X.R * B.edges[std::size_t(x.b.index)].direction);
    if (across.norm() <= tolerances::kCrossingSine) continue;
    ++crossing;
    const double left = double(x.distance - oracle::support_gap(A, B, X, x.normal));
    ASSERT_LE(left, x.error_bound) << cases::describe(X);
    ASSERT_LE((x.p_a - x.p_b - x.normal * x.distance).norm(), x.error_bound);
    ASSERT_LE(off_line(A, x.a.index, {}, x.p_a), x.error_bound + 1e-15 * A.extent.size);
    ASSERT_LE(off_line(B, x.b.index, X, x.p_b), x.error_bound + 1e-15 * (A.extent.size + B.extent.size));
  }
  std::printf("  %d pairs of crossing edges\n", crossing);
  EXPECT_GT(crossing, cases::some_of(200000) / 20);
}

/// Over the border of a flat or sharp piece: by its two faces' numbers a point there may be outside the
/// column of one and inside that of the other, below it.
TEST(ClosestFeatures, RoundingAtASharpEdgeLeadsNobodyInCircles) {
  Random random(20281);
  const Polytope tip = *convex_hull({{0, 0, 0}, {0.01, 0, 0.05}, {-0.01, 0.01, 0.05}, {0, -0.01, 0.05}});
  const auto lowest =
      std::find_if(tip.vertices.begin(), tip.vertices.end(), [](const Vec3& v) { return v.isZero(); });
  const Feature point{FeatureKind::kVertex, int(lowest - tip.vertices.begin())};
  for (int i = 0; i < cases::some_of(200000); ++i) {
    const Mat3 turned = cases::random_rotation(random);  // of the triangle's frame
    const std::array<Vec3, 3> flat = {Vec3(0, 0, 0), Vec3(random.uniform(0.02, 0.1), 0, 0),
                                      Vec3(random.uniform(-0.05, 0.05), random.uniform(0.02, 0.1), 0)};
    std::vector<Vec3> corners;
    for (const Vec3& corner : flat) corners.push_back(turned * corner);
    Result<Polytope> piece = flat_polygon(corners);
    if (i % 2) {  // a wedge: the same triangle with little below it
      corners.push_back(turned *
                        Vec3((flat[0] + flat[1] + flat[2]) / 3.0 - Vec3(0, 0, random.uniform(1e-6, 1e-3))));
      piece = convex_hull(corners);
    }
    ASSERT_TRUE(piece) << piece.error().message();
    // Over the border from corner 0 to 1, whose outside is -y, as far out as still counts for the column.
    Vec3 over(random.uniform(0.2, 0.8) * flat[1].x(), 0.0, random.uniform(1e-5, 1e-3));
    over.y() = -random.uniform(0.9, 1.2) * tolerances::kVoronoiTolerance *
               (over.lpNorm<1>() + tip.extent.magnitude + piece->extent.magnitude);
    Pose X_AB;  // the tip's axis up the triangle's normal, its point at `over`
    X_AB.R = turned.transpose();
    X_AB.p = -over;
    PairCache cache;
    cache.a = point;
    cache.b = {FeatureKind::kFace, 0};
    for (std::size_t f = 0; f < piece->faces.size(); ++f)
      if (piece->faces[f].normal.dot(turned.col(2)) > 0.999999999) cache.b.index = int(f);
    const PairDistance x = closest_features(tip, *piece, X_AB, cache);
    ASSERT_EQ(x.stop, Stop::kCertified) << i;
    ASSERT_LE(x.steps, 6) << i;
    ASSERT_NEAR(x.distance, over.z(), 1e-12) << i;
  }
}

/// B beside A, the pose `broken` by one of its twelve numbers: nothing may be proved of it, whatever is known
/// from before, and nothing of it may be left when the pose is good again.
void expect_nothing_of(const Polytope& A, const Polytope& B, const Pose& good, const Pose& broken) {
  PairCache tracked;
  closest_features(A, B, good, tracked);
  PairCache of_faces;
  of_faces.a = of_faces.b = {FeatureKind::kFace, 0};
  for (PairCache cache : {PairCache{}, tracked, of_faces}) {
    for (int frame = 0; frame < 4; ++frame) {
      const PairDistance x = closest_features(A, B, broken, cache);
      ASSERT_FALSE(x.certified());
      ASSERT_TRUE(std::isnan(x.distance));
      ASSERT_TRUE(valid_feature(A, x.a) && valid_feature(B, x.b));
    }
    PairCache inside = cache;
    for (int frame = 0; frame < 12; ++frame)
      ASSERT_FALSE(penetration_depth(A, B, broken, inside).certified());
    const TimeOfImpact impact = time_of_impact(A, {}, {}, B, broken, {}, 1e-3, 1e-5, inside);
    ASSERT_EQ(impact.status, ImpactStatus::kBounded);
    ASSERT_EQ(impact.time, 0.0);
    ASSERT_TRUE(closest_features(A, B, good, cache).certified());
    ASSERT_TRUE(closest_features(A, B, good, inside).certified());
  }
  ASSERT_FALSE(depth_along(A, B, broken, Vec3::UnitX()).certified());
}

TEST(ClosestFeatures, OfAPoseThatIsNotFiniteNothingIsCertified) {
  Random random(20271);
  const auto shapes = cases::shapes(random, true);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (int i = 0; i < cases::some_of(4000); ++i) {
    const cases::Shape& a = shapes[std::size_t(random.index(int(shapes.size())))];
    const cases::Shape& b = shapes[std::size_t(random.index(int(shapes.size())))];
    const Polytope& A = a.polytope;
    const Polytope& B = b.polytope;
    // Apart, touching, inside; with faces level or turned any way, centre over centre or beside.
    const double apart = random.uniform(0.0, 1.2) * (A.extent.radius + B.extent.radius);
    Pose good{i % 2 ? Mat3::Identity() : cases::random_rotation(random), Vec3::Zero()};
    const Vec3 toward = i % 3 ? cases::random_unit(random) : Vec3(Vec3::UnitZ());
    good.p = A.extent.center - good.R * B.extent.center + apart * toward;
    Pose broken = good;
    if (random.index(2) == 0) broken.R = cases::random_rotation(random);
    const int entry = random.index(12);
    (entry < 3 ? broken.p[entry] : broken.R(entry % 3, entry / 3 - 1)) =
        std::array{std::nan(""), kInfinity, -kInfinity}[std::size_t(random.index(3))];
    SCOPED_TRACE(a.name + " / " + b.name + ", case " + std::to_string(i) + cases::describe(broken));
    expect_nothing_of(A, B, good, broken);
    if (HasFatalFailure()) return;
  }
}

/// So far away that squares of lengths are infinite: the answer may be poor, but must not be an overlap.
TEST(ClosestFeatures, OfPiecesUnthinkablyFarApartNoContactIsTold) {
  Random random(20272);
  const auto shapes = cases::shapes(random, true);
  for (const cases::Shape& a : shapes)
    for (const double far : {1e12, 1e100, 1e200, 1e300}) {
      const Polytope& P = a.polytope;
      SCOPED_TRACE(a.name);
      const Pose X{cases::random_rotation(random), far * cases::random_unit(random)};
      PairCache cache;
      for (int frame = 0; frame < 2; ++frame) {
        const PairDistance x = closest_features(P, P, X, cache);
        EXPECT_FALSE(x.certified() && x.distance <= 0.0) << "at " << far;
        EXPECT_TRUE(valid_feature(P, x.a) && valid_feature(P, x.b)) << "at " << far;
      }
    }
}

}  // namespace
}  // namespace tactum
