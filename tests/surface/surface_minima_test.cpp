#include "tactum/surface/surface_minima.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "collision/cases.h"
#include "oracles/minima_referee.h"
#include "support/allocation_guard.h"
#include "support/real_data.h"
#include "support/sample_meshes.h"
#include "support/surface_shapes.h"
#include "tactum/devices/motion_file.h"
#include "tactum/geometry/weld.h"
#include "tactum/mesh/mesh_import.h"
#include "tactum/surface/surface_distance.h"

namespace tactum {
namespace {

using testing::box_mesh;

constexpr double kErrorBound = 1e-7;

std::vector<int> corners_of(const SurfaceTree& tree, const Feature& feature) {
  std::vector<int> corners;
  if (feature.kind == FeatureKind::kVertex) corners = {feature.index};
  if (feature.kind == FeatureKind::kEdge) {
    const std::array<int, 2> edge = tree.edge(feature.index);
    corners = {edge[0], edge[1]};
  }
  if (feature.kind == FeatureKind::kFace) {
    const Triangle& t = tree.triangle(feature.index);
    corners = {t[0], t[1], t[2]};
  }
  std::sort(corners.begin(), corners.end());
  return corners;
}

std::string described(const oracles::RefereeMinimum& m) {
  std::string text = "(";
  for (int v : m.a) text += std::to_string(v) + " ";
  text += "| ";
  for (int v : m.b) text += std::to_string(v) + " ";
  return text + ") at " + std::to_string(m.distance) + ", margin " + std::to_string(m.margin);
}

std::vector<SurfaceMinimum> query(const SurfaceTree& a, const SurfaceTree& b, const Pose& X_AB,
                                  const MinimaQuery& what) {
  std::vector<SurfaceMinimum> found;
  found.reserve(1 << 16);
  const MinimaWork work = surface_minima(a, b, X_AB, what, found);
  EXPECT_FALSE(work.full);
  EXPECT_EQ(work.minima, static_cast<int>(found.size()));
  return found;
}

/// Every minimum of the referee is found and nothing else is, but for those that rounding decides. Returns
/// how many.
int expect_as_referee(const TriangleMesh& mesh_a, const TriangleMesh& mesh_b, const Pose& X_AB,
                      const MinimaQuery& what) {
  const SurfaceTree a(mesh_a);
  const SurfaceTree b(mesh_b);
  const std::vector<SurfaceMinimum> found = query(a, b, X_AB, what);
  const auto truth = oracles::every_minimum(mesh_a, mesh_b, X_AB, what, kErrorBound);
  const double length = 1e-9 * std::max(a.size(), b.size());
  std::vector<int> claimed(truth.size(), 0);
  for (const SurfaceMinimum& m : found) {
    const std::vector<int> corners_a = corners_of(a, m.a);
    const std::vector<int> corners_b = corners_of(b, m.b);
    bool known = false;
    for (std::size_t i = 0; i < truth.size() && !known; ++i) {
      known = truth[i].a == corners_a && truth[i].b == corners_b && claimed[i] == 0 &&
              std::abs(truth[i].distance - m.distance) < length && (truth[i].p_a - m.p_a).norm() < length &&
              (truth[i].p_b - m.p_b).norm() < length && (truth[i].normal - m.normal).norm() < kErrorBound;
      if (known) claimed[i] = 1;
    }
    EXPECT_TRUE(known) << "no minimum: kinds " << int(m.a.kind) << int(m.b.kind) << " at " << m.distance
                       << ", " << cases::describe(X_AB);
    EXPECT_NEAR(m.distance, m.normal.dot(m.p_a - m.p_b), length);
    EXPECT_NEAR((m.p_b + m.normal * m.distance - m.p_a).norm(), 0.0, length);
    if (!known) return static_cast<int>(found.size());
  }
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (truth[i].margin < kErrorBound || claimed[i] != 0) continue;
    ADD_FAILURE() << "missed " << described(truth[i]) << ", " << cases::describe(X_AB);
    break;
  }
  return static_cast<int>(found.size());
}

/// B moved along `direction` until the surfaces are `gap` apart.
Pose approached(const TriangleMesh& mesh_a, const TriangleMesh& mesh_b, const Mat3& R, const Vec3& direction,
                double gap) {
  const Surface a(mesh_a);
  const Surface b(mesh_b);
  SurfacePairCache cache;
  Pose X{R, (a.size() + b.size()) * direction};
  for (int step = 0; step < 200; ++step) {
    const double left = surface_distance(a, b, X, cache).distance - gap;
    if (left < 0.01 * gap) break;
    X.p -= left * direction;
  }
  return X;
}

struct Pair {
  const char* name;
  TriangleMesh a, b;
  double max_distance;
};

std::vector<Pair> pairs(Random& random) {
  std::vector<Pair> list;
  const TriangleMesh box = box_mesh({0.02, 0.03, 0.01});
  const TriangleMesh ball =
      testing::transformed(testing::icosphere(2), 0.02 * Mat3::Identity(), Vec3::Zero());
  list.push_back({"box, box", box, box_mesh({0.01, 0.015, 0.02}), 1e-3});
  list.push_back({"box, prism", box, testing::prism(12, 0.01, 0.02), 1e-3});
  list.push_back({"tori", testing::torus(16, 8, 0.02, 0.006), testing::torus(12, 10, 0.015, 0.005), 2e-3});
  list.push_back(
      {"rough balls", testing::roughened(ball, random, 0.1), testing::roughened(ball, random, 0.05), 3e-3});
  list.push_back({"rough ball, sheet", testing::roughened(ball, random, 0.1),
                  testing::bumpy_sheet(random, 8, 0.04, 1e-3), 2e-3});
  list.push_back({"sheets", testing::bumpy_sheet(random, 6, 0.03, 5e-4),
                  testing::bumpy_sheet(random, 8, 0.04, 1e-3), 2e-3});
  list.push_back({"two boxes on one edge, prism",
                  testing::joined(box, testing::transformed(box, Mat3::Identity(), {0.04, 0.06, 0})),
                  testing::prism(7, 0.01, 0.01), 1e-3});
  return list;
}

TEST(SurfaceMinima, AreThoseOfEveryPairOfFeatures) {
  const std::uint64_t seed = 20260101;
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
  Random random(seed);
  for (const Pair& pair : pairs(random)) {
    SCOPED_TRACE(pair.name);
    int found = 0;
    const int poses = std::max(2, cases::some_of(cases::full() ? 400 : 12));
    for (int i = 0; i < poses; ++i) {
      const Mat3 R = cases::random_rotation(random);
      const Pose X = approached(pair.a, pair.b, R, cases::random_unit(random),
                                random.uniform(0.05, 0.9) * pair.max_distance);
      const double inflation = i % 3 == 0 ? 0.0 : random.uniform(0.0, 0.05);
      found += expect_as_referee(pair.a, pair.b, X,
                                 {pair.max_distance, i % 2 ? 0.3 * pair.max_distance : 0.0, inflation});
    }
    EXPECT_GT(found, poses / 5);
  }
}

TEST(SurfaceMinima, OfCrossedSurfacesAreThoseOfEveryPairOfFeatures) {
  Random random(77);
  int all_negative = 0;
  for (const Pair& pair : pairs(random)) {
    SCOPED_TRACE(pair.name);
    int negative = 0;
    for (int i = 0; i < std::max(2, cases::some_of(6)); ++i) {
      const Vec3 direction = cases::random_unit(random);
      Pose X =
          approached(pair.a, pair.b, cases::random_rotation(random), direction, 0.05 * pair.max_distance);
      X.p -= 0.1 * pair.max_distance * direction;
      const MinimaQuery what{pair.max_distance, 0.5 * pair.max_distance, 0.004};
      expect_as_referee(pair.a, pair.b, X, what);
      for (const SurfaceMinimum& m : query(SurfaceTree(pair.a), SurfaceTree(pair.b), X, what))
        negative += int(m.distance < 0.0);
    }
    all_negative += negative;
  }
  EXPECT_GT(all_negative, 0);
}

TEST(SurfaceMinima, OfANutOnABoltAreThoseOfEveryPairOfFeatures) {
  testing::Thread thread;
  thread.turns = 2;
  thread.segments = 20;
  const TriangleMesh bolt = testing::thread_mesh(thread);
  thread.inner = true;
  thread.turns = 1;
  thread.offset = 1e-4;
  const TriangleMesh nut = testing::thread_mesh(thread);
  Random random(5);
  for (int i = 0; i < std::max(1, cases::some_of(6)); ++i) {
    const double turn = random.uniform(-0.3, 0.3);
    Pose X{exp_rotation(Vec3(0, 0, turn)), {0, 0, thread.pitch * (1.0 + turn / (2 * kPi))}};
    X.R = exp_rotation(cases::random_vector(random, 2e-3)) * X.R;
    X.p += cases::random_vector(random, 2e-5);
    EXPECT_GT(expect_as_referee(bolt, nut, X, {2e-4, 5e-5, i % 2 ? 0.004 : 0.0}), 10);
  }
}

/// Checks that surface_clearance() is no more than the distance, and no less than nine tenths of it. For
/// surfaces that cross there is no such bound: then this is false.
bool expect_clearance(const Surface& of_a, const Surface& of_b, const SurfaceTree& a, const SurfaceTree& b,
                      const Pose& X, double max_distance) {
  SurfacePairCache cache;
  const double distance = surface_distance(of_a, of_b, X, cache).distance;
  if (distance == 0.0) return false;
  MinimaWork work;
  const double clearance = surface_clearance(a, b, X, {max_distance, 1e-3 * max_distance, 4e-3}, work);
  EXPECT_LE(clearance, distance + 1e-9 * a.size());
  EXPECT_GE(clearance, std::min(max_distance, 0.9 * distance) - 1e-9 * a.size()) << "of " << distance;
  return true;
}

struct RealPair {
  const char *a, *b, *motion;
  double max_distance;
};

/// Slivers a hundred times as long as wide, edges parallel to a thousandth, flat sides side by side.
TEST(SurfaceMinima, OfRealPartsAreThoseOfEveryPairOfFeatures) {
  TACTUM_NEEDS_REAL_DATA();
  for (const RealPair& real : {RealPair{"industreal_gear_medium.obj", "industreal_gear_small.obj",
                                        "gears_medium_small_motion.csv", 1e-4},
                               RealPair{"factory_bolt_m16_loose.obj", "factory_nut_m16_loose_subdiv_3x.obj",
                                        "m16_loose_screw_motion.csv", 2e-4}}) {
    SCOPED_TRACE(real.motion);
    int found = 0;
    int apart = 0;
    const auto mesh = [](const char* name) {
      const Result<ImportedMesh> read = import_mesh(testing::find_real(name).string());
      EXPECT_TRUE(read) << name;
      WeldOptions options;
      options.drop_zero_area = options.drop_duplicates = true;
      return weld(read->mesh, options).mesh;
    };
    const TriangleMesh a = mesh(real.a);
    const TriangleMesh b = mesh(real.b);
    const Result<TwoBodyMotion> motion = read_two_body_motion(testing::find_real(real.motion).string());
    ASSERT_TRUE(motion);
    const SurfaceTree tree_a(a);
    const SurfaceTree tree_b(b);
    const Surface surface_a(a);
    const Surface surface_b(b);
    const std::size_t step = testing::full_run() ? 5 : 100;
    // In a sanitized build the referee of every pair of features takes half a minute a pose.
    for (std::size_t i = 33; !testing::kSanitized && i < motion->frame.size(); i += step) {
      SCOPED_TRACE(i);
      const Pose X = relative_pose(motion->X_WA[i], motion->X_WB[i]);
      found += expect_as_referee(a, b, X, {real.max_distance, 0.0, 4e-3});
    }
    for (std::size_t i = 0; i < motion->frame.size();
         i += testing::full_run() ? 5 : testing::effort(20, 100)) {
      SCOPED_TRACE(i);
      const Pose X = relative_pose(motion->X_WA[i], motion->X_WB[i]);
      apart += int(expect_clearance(surface_a, surface_b, tree_a, tree_b, X, 8.0 * real.max_distance));
    }
    EXPECT_TRUE(found > 0 || testing::kSanitized);
    EXPECT_GT(apart, 0);
  }
}

TEST(SurfaceMinima, HoldTheDistanceOfTheSurfaces) {
  Random random(3);
  for (const Pair& pair : pairs(random)) {
    SCOPED_TRACE(pair.name);
    const bool open = std::string(pair.name).find("sheet") != std::string::npos;
    if (open) continue;  // from behind a sheet is not felt
    const SurfaceTree a(pair.a);
    const SurfaceTree b(pair.b);
    for (int i = 0; i < std::max(2, cases::some_of(20)); ++i) {
      const Pose X = approached(pair.a, pair.b, cases::random_rotation(random), cases::random_unit(random),
                                random.uniform(0.05, 0.9) * pair.max_distance);
      SurfacePairCache cache;
      const double distance = surface_distance(Surface(pair.a), Surface(pair.b), X, cache).distance;
      double least = 1.0;
      for (const SurfaceMinimum& m : query(a, b, X, {pair.max_distance, 0.0, 0.0})) {
        EXPECT_TRUE(m.strict);
        least = std::min(least, m.distance);
      }
      EXPECT_NEAR(least, distance, 1e-9 * a.size());
    }
  }
}

TEST(SurfaceMinima, TellHowFarApartSurfacesAre) {
  Random random(4);
  for (const Pair& pair : pairs(random)) {
    SCOPED_TRACE(pair.name);
    if (std::string(pair.name).find("sheet") != std::string::npos) continue;  // from behind not felt
    for (int i = 0; i < std::max(2, cases::some_of(20)); ++i) {
      const Pose X = approached(pair.a, pair.b, cases::random_rotation(random), cases::random_unit(random),
                                random.uniform(0.05, 3.0) * pair.max_distance);
      EXPECT_TRUE(expect_clearance(Surface(pair.a), Surface(pair.b), SurfaceTree(pair.a), SurfaceTree(pair.b),
                                   X, 2.0 * pair.max_distance));
    }
  }
}

/// A box of half extents (1, 1, 1) cm flat on a large one, turned about the vertical, `gap` above it.
Pose flat_on_top(double angle, double gap, double z_below) {
  return {exp_rotation(Vec3(0, 0, angle)), {0.001, 0.002, z_below + 0.01 + gap}};
}

TEST(SurfaceMinima, OfFlatContactSupportAllItsCorners) {
  const SurfaceTree plate(box_mesh({0.05, 0.05, 0.01}));
  const SurfaceTree cube(box_mesh({0.01, 0.01, 0.01}));
  for (double angle : {0.0, 0.3, kPi / 4}) {
    for (double tilt : {0.0, 1e-3, -2e-3}) {
      Pose X = flat_on_top(angle, 3e-5, 0.01);
      X.R = exp_rotation(Vec3(tilt, 0.5 * tilt, 0)) * X.R;
      std::vector<int> corners;
      for (const SurfaceMinimum& m : query(plate, cube, X, {1e-4, 0.0, 4e-3})) {
        EXPECT_LT(m.normal.z(), -0.99);  // from the cube to the plate
        if (m.b.kind == FeatureKind::kVertex && m.a.kind == FeatureKind::kFace) corners.push_back(m.b.index);
      }
      std::sort(corners.begin(), corners.end());
      corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
      EXPECT_EQ(corners.size(), 4u) << angle << " " << tilt;
    }
  }
  // Without the inflation only the lowest corner of a tilted cube is one.
  Pose X = flat_on_top(0.3, 3e-5, 0.01);
  X.R = exp_rotation(Vec3(1e-3, 5e-4, 0)) * X.R;
  EXPECT_EQ(query(plate, cube, X, {6e-5, 0.0, 0.0}).size(), 1u);
}

TEST(SurfaceMinima, OfPlatesThatOverhangAreTheCrossingsOfTheirOutlines) {
  const SurfaceTree below(box_mesh({0.05, 0.01, 0.01}));
  const SurfaceTree above(box_mesh({0.01, 0.05, 0.01}));
  const Pose X{Mat3::Identity(), {0, 0, 0.02 + 2e-5}};
  std::vector<Vec3> ends;
  for (const SurfaceMinimum& m : query(below, above, X, {6e-5, 0.0, 4e-3})) {
    EXPECT_EQ(m.a.kind, FeatureKind::kEdge);
    EXPECT_EQ(m.b.kind, FeatureKind::kEdge);
    EXPECT_NEAR(std::abs(m.p_a.x()), 0.01, 1e-12);
    EXPECT_NEAR(std::abs(m.p_a.y()), 0.01, 1e-12);
    EXPECT_NEAR(m.distance, 2e-5, 1e-12);
    ends.push_back(m.p_a);
  }
  EXPECT_EQ(ends.size(), 4u);
}

TEST(SurfaceMinima, OfParallelEdgesAreTheEndsOfWhatTheyShare) {
  // Two wedges, their ridges along x, one above the other.
  TriangleMesh ridge;
  ridge.vertices = {{-0.01, 0, 0}, {0.01, 0, 0}, {0, -0.01, -0.01}, {0, 0.01, -0.01}};
  ridge.triangles = {{0, 2, 1}, {0, 1, 3}};
  const SurfaceTree tree(ridge);
  Pose X{exp_rotation(Vec3(kPi, 0, 0)), {0.005, 0, 3e-5}};
  std::vector<double> ends;
  for (const SurfaceMinimum& m : query(tree, tree, X, {6e-5, 0.0, 0.0})) {
    EXPECT_NEAR(m.distance, 3e-5, 1e-15);
    EXPECT_NEAR(m.normal.z(), -1.0, 1e-12);
    if (m.a.kind == FeatureKind::kEdge && m.b.kind == FeatureKind::kEdge) ends.push_back(m.p_a.x());
  }
  ASSERT_EQ(ends.size(), 2u);
  EXPECT_NEAR(std::min(ends[0], ends[1]), -0.005, 1e-12);
  EXPECT_NEAR(std::max(ends[0], ends[1]), 0.01, 1e-12);
}

TEST(SurfaceMinima, OfAThinWallKeepItsSidesApart) {
  // A wall 20 um thick between two blocks 10 um from either side, closer to the far side than the largest
  // distance.
  const SurfaceTree wall(box_mesh({0.01, 0.01, 1e-5}));
  const TriangleMesh block = box_mesh({0.005, 0.005, 0.005});
  const SurfaceTree blocks(
      testing::joined(testing::transformed(block, Mat3::Identity(), {0, 0, 0.005 + 2e-5}),
                      testing::transformed(block, Mat3::Identity(), {0, 0, -0.005 - 2e-5})));
  const auto found = query(wall, blocks, Pose(), {6e-5, 5e-6, 4e-3});
  EXPECT_GE(found.size(), 8u);
  for (const SurfaceMinimum& m : found) {
    EXPECT_NEAR(m.distance, 1e-5, 1e-12);
    EXPECT_GT(-m.normal.z() * m.p_b.z(), 0.0);  // each side is met from its own side
  }
}

TEST(SurfaceMinima, IgnoreEdgesAndCornersInsideAFlatFace) {
  // A plate cut into a grid of triangles; a ball slides over it: one minimum, never an edge of the plate.
  Random random(1);
  const SurfaceTree plate(testing::bumpy_sheet(random, 16, 0.05, 0.0));
  const SurfaceTree ball(testing::transformed(testing::icosphere(2), 0.01 * Mat3::Identity(), Vec3::Zero()));
  for (int i = 0; i < 50; ++i) {
    const Pose X{Mat3::Identity(), {random.uniform(-0.02, 0.02), random.uniform(-0.02, 0.02), 0.01 + 1e-5}};
    for (const SurfaceMinimum& m : query(plate, ball, X, {6e-5, 0.0, 4e-3})) {
      EXPECT_EQ(m.a.kind, FeatureKind::kFace);
      EXPECT_NEAR(m.normal.z(), -1.0, 1e-12);
    }
  }
}

TEST(SurfaceMinima, SwapWithTheirSurfaces) {
  Random random(9);
  for (const Pair& pair : pairs(random)) {
    const SurfaceTree a(pair.a);
    const SurfaceTree b(pair.b);
    const Pose X = approached(pair.a, pair.b, cases::random_rotation(random), cases::random_unit(random),
                              0.3 * pair.max_distance);
    const MinimaQuery what{pair.max_distance, 0.1 * pair.max_distance, 0.004};
    const auto there = query(a, b, X, what);
    const auto back = query(b, a, X.inverse(), what);
    ASSERT_EQ(there.size(), back.size()) << pair.name;
    for (const SurfaceMinimum& m : there) {
      const bool known = std::any_of(back.begin(), back.end(), [&](const SurfaceMinimum& other) {
        return other.a == m.b && other.b == m.a && std::abs(other.distance - m.distance) < 1e-12 &&
               (X * other.p_b - m.p_a).norm() < 1e-12 && (X.R * other.normal + m.normal).norm() < 1e-6;
      });
      EXPECT_TRUE(known) << pair.name;
    }
  }
}

TEST(SurfaceMinima, AreSortedTheSameAndTakeNoMemory) {
  const SurfaceTree a(testing::torus(40, 20, 0.02, 0.006));
  const Pose X{exp_rotation(Vec3(0.001, 0.002, 0.3)), {0, 0, 0.01205}};
  std::vector<SurfaceMinimum> first;
  std::vector<SurfaceMinimum> second;
  first.reserve(10000);
  second.reserve(10000);
  const MinimaQuery what{2e-3, 1e-4, 0.01};
  const AllocationGuard guard;
  surface_minima(a, a, X, what, first);
  surface_minima(a, a, X, what, second);
  const std::size_t allocations = guard.allocations();
  EXPECT_EQ(allocations, 0u);
  ASSERT_EQ(first.size(), second.size());
  EXPECT_GT(first.size(), 10u);
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].distance, second[i].distance);
    if (i == 0) continue;
    const auto key = [](const SurfaceMinimum& m) {
      return std::make_tuple(m.a.kind, m.a.index, m.b.kind, m.b.index);
    };
    EXPECT_LE(key(first[i - 1]), key(first[i]));
  }
}

TEST(SurfaceMinima, KeepTheNearestWhenTheRoomIsFull) {
  const SurfaceTree a(testing::torus(40, 20, 0.02, 0.006));
  const Pose X{exp_rotation(Vec3(0.001, 0.002, 0.3)), {0, 0, 0.01205}};
  const MinimaQuery what{2e-3, 1e-4, 0.01};
  std::vector<double> all;
  for (const SurfaceMinimum& m : query(a, a, X, what)) all.push_back(m.distance);
  std::sort(all.begin(), all.end());
  std::vector<SurfaceMinimum> few;
  few.reserve(7);
  const MinimaWork work = surface_minima(a, a, X, what, few);
  EXPECT_TRUE(work.full);
  EXPECT_EQ(work.minima, static_cast<int>(all.size()));
  ASSERT_EQ(few.size(), 7u);
  std::vector<double> kept;
  for (const SurfaceMinimum& m : few) kept.push_back(m.distance);
  std::sort(kept.begin(), kept.end());
  EXPECT_TRUE(std::equal(kept.begin(), kept.end(), all.begin()));
}

TEST(SurfaceMinima, OfNothingAndOfNonsenseAreNone) {
  const SurfaceTree box(box_mesh({0.01, 0.01, 0.01}));
  EXPECT_TRUE(query(box, SurfaceTree(), Pose(), {1e-3, 0.0, 0.0}).empty());
  EXPECT_TRUE(query(SurfaceTree(), box, Pose(), {1e-3, 0.0, 0.0}).empty());
  const Pose nowhere{Mat3::Identity(), Vec3::Constant(std::nan(""))};
  EXPECT_TRUE(query(box, box, nowhere, {1e-3, 0.0, 0.0}).empty());
}

}  // namespace
}  // namespace tactum
