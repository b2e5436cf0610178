#include "tactum/surface/surface_path.h"

#include <gtest/gtest.h>

#include <array>

#include "support/effort.h"
#include "support/sample_meshes.h"
#include "support/surface_shapes.h"
#include "tactum/math/path_search.h"
#include "tactum/surface/surface_distance.h"

namespace tactum {
namespace {

using testing::box_mesh;
using testing::effort;
using testing::icosphere;
using testing::torus;
using testing::transformed;

constexpr int kAmple = 1'000'000;

TriangleMesh reversed(TriangleMesh mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

/// Two triangles.
TriangleMesh sheet(double half) {
  TriangleMesh mesh;
  mesh.vertices = {{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

Vec3 some_vector(Random& random, double length) {
  const Vec3 v(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
  return v.normalized() * length;
}

double distance(const Surface& a, const Surface& b, const Pose& X_AB) {
  SurfacePairCache cache;
  return surface_distance(a, b, X_AB, cache, TouchingPairs::kFirst).distance;
}

/// Motions of a size from a fraction of the gap to far through, with turns: no sample of the part that is
/// called free touches, and where it ends the surfaces are near.
TEST(SurfacePath, IsFreeUpToWhereSamplesOfTheDistanceTouch) {
  Random random(71);
  const TriangleMesh ring = torus(24, 10, 0.02, 0.003);
  TriangleMesh rough = torus(16, 8, 0.015, 0.004);
  rough = testing::roughened(rough, random, 0.05);
  const std::vector<TriangleMesh> meshes = {
      ring,
      rough,
      sheet(0.02),
      reversed(ring),
      transformed(icosphere(1), 0.012 * Mat3::Identity(), {0.005, 0, 0}),
      box_mesh({0.02, 0.001, 0.006})};
  int free = 0, ended = 0;
  for (int i = 0; i < effort(400, 40); ++i) {
    const TriangleMesh& of_a = meshes[std::size_t(random.index(int(meshes.size())))];
    const TriangleMesh& of_b = meshes[std::size_t(random.index(int(meshes.size())))];
    const SurfaceTree a(of_a), b(of_b);
    const Surface distance_a(of_a), distance_b(of_b);
    const Pose start{exp_rotation(some_vector(random, random.uniform(0, 3))),
                     some_vector(random, random.uniform(0.0, 0.05))};
    if (!(distance(distance_a, distance_b, start) > 1e-5)) continue;
    const RelativeMotion motion{start,
                                {some_vector(random, std::pow(10.0, random.uniform(-5, -1))),
                                 some_vector(random, std::pow(10.0, random.uniform(-4, 0)))},
                                start.p + some_vector(random, random.uniform(0.0, 0.03))};
    const SurfacePath path = surface_path(a, b, motion, kAmple);
    ASSERT_GE(path.free, 0.0);
    ASSERT_LE(path.free, 1.0);
    const double travel = motion.by.v.norm() + motion.by.w.norm() * 0.07;
    const bool may_rise = motion.by.w.norm() <= kHardlyTurns;  // and need not go on lines
    for (int k = may_rise ? 60 : 0; k <= 60; ++k)
      ASSERT_GT(distance(distance_a, distance_b, motion.at(path.free * k / 60)), 0.0) << "case " << i;
    if (path.free == 1.0) {
      ++free;
      continue;
    }
    ++ended;
    EXPECT_LT(distance(distance_a, distance_b, motion.at(path.free)), 3e-3 * travel) << "case " << i;
    EXPECT_GE(path.triangle_a, 0);
  }
  EXPECT_GT(free, effort(100, 8));
  EXPECT_GT(ended, effort(15, 1));
}

/// What is thinner than the motion is not passed, from either side, and however it is wound.
TEST(SurfacePath, EndsAtASheetWhateverItsWinding) {
  const TriangleMesh ball = transformed(icosphere(1), 0.001 * Mat3::Identity(), Vec3::Zero());
  for (const bool turned : {false, true}) {
    for (const double from : {-1.0, 1.0}) {
      for (const double far : {0.02, 1.0, 100.0}) {
        const SurfaceTree a(turned ? reversed(sheet(0.02)) : sheet(0.02)), b(ball);
        const RelativeMotion motion{{Mat3::Identity(), {0.003, 0.001, from * 0.005}},
                                    {{0, 0, -from * far}, {0.1, 0, 0}}};
        const SurfacePath path = surface_path(a, b, motion, kAmple);
        EXPECT_NEAR(path.free * far, 0.004, 2e-4 * far + 5e-5);
        EXPECT_LT(path.free * far, 0.0042);
      }
    }
  }
}

/// Sliding at a gap of a thousandth of the motion is free: the planes of the faces prove it.
TEST(SurfacePath, LetsSurfacesSlideOnEachOther) {
  const SurfaceTree floor(box_mesh({0.1, 0.1, 0.01}));
  const SurfaceTree block(box_mesh({0.01, 0.01, 0.01}));
  for (const double gap : {1e-3, 1e-6, 1e-9, 1e-12}) {
    const Pose start{Mat3::Identity(), {0, 0, 0.02 + gap}};
    EXPECT_EQ(surface_path(floor, block, {start, {{1e-3, 2e-3, 0}, {0, 0, 0.1}}}, kAmple).free, 1.0) << gap;
    EXPECT_LT(surface_path(floor, block, {start, {{1e-3, 2e-3, -2e-3}, Vec3::Zero()}}, kAmple).free,
              gap / 1e-3);
  }
}

/// Surfaces that touch may part and slide, but not come nearer.
TEST(SurfacePath, OfSurfacesThatTouch) {
  const SurfaceTree floor(box_mesh({0.5, 0.5, 0.25}));
  const SurfaceTree block(box_mesh({0.25, 0.25, 0.25}));
  const Pose start{Mat3::Identity(), {0, 0, 0.5}};
  EXPECT_EQ(surface_path(floor, block, {start, {{0.01, 0, 0}, Vec3::Zero()}}, kAmple).free, 1.0);
  EXPECT_EQ(surface_path(floor, block, {start, {{0.01, 0, 0.01}, Vec3::Zero()}}, kAmple).free, 1.0);
  EXPECT_EQ(surface_path(floor, block, {start, {{0.01, 0, -0.01}, Vec3::Zero()}}, kAmple).free, 0.0);
  const Pose crossed{Mat3::Identity(),
                     {0.1, 0.05, 0.4}};  // what has crossed already is no crossing of this motion
  EXPECT_EQ(surface_path(floor, block, {crossed, {{0.001, 0, -0.001}, Vec3::Zero()}}, kAmple).free, 1.0);
}

/// A block whose bottom is a little below the top of the board that it comes to.
TEST(SurfacePath, RidesOverStepsOfTheHeightGiven) {
  const SurfaceTree board(box_mesh({0.02, 0.02, 0.01}));
  const SurfaceTree block(box_mesh({0.01, 0.01, 0.01}));
  for (const double step : {1e-7, 1e-6, 1e-5}) {
    const Vec3 from(0.03 + 1e-4, 0, 0.02 - step);
    const Vec3 move(-1e-3, 1e-4, 0);
    const std::array<Vec3, 1> from_block = {-Vec3::UnitZ()};
    const std::array<Vec3, 1> from_board = {Vec3::UnitZ()};
    const std::array<Vec3, 1> aside = {Vec3::UnitY()};
    const auto free = [&](const std::array<Vec3, 1>& normals, double height) {
      return surface_path(board, block, {{Mat3::Identity(), from}, {move, Vec3::Zero()}}, kAmple,
                          {normals, height})
          .free;
    };
    EXPECT_EQ(free(from_block, 1.1 * step), 1.0) << step;
    EXPECT_NEAR(free(from_block, 0.9 * step), 0.1, 0.01) << step;
    EXPECT_NEAR(free(aside, 1.1 * step), 0.1, 0.01) << step;
    EXPECT_NEAR(free(from_board, 1.1 * step), 0.1, 0.01) << step;
    const RelativeMotion seen_from_block{{Mat3::Identity(), -from}, {-move, Vec3::Zero()}};
    EXPECT_EQ(surface_path(block, board, seen_from_block, kAmple, {from_board, 1.1 * step}).free, 1.0)
        << step;
  }
}

TEST(SurfacePath, SaysWhenItsTestsRunOut) {
  const SurfaceTree a(torus(24, 10, 0.02, 0.003));
  const RelativeMotion motion{{exp_rotation({1.2, 0.3, 0}), {0.02, 0, 0}}, {{1e-2, 1e-2, 0}, {0.3, 0, 0}}};
  EXPECT_EQ(surface_path(a, a, motion, 3).complete, false);
}

}  // namespace
}  // namespace tactum
