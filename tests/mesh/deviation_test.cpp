#include "tactum/mesh/deviation.h"

#include <gtest/gtest.h>

#include "collision/cases.h"
#include "support/sample_meshes.h"
#include "tactum/base/random.h"
#include "tactum/collision/penetration.h"
#include "tactum/geometry/hull.h"
#include "tactum/geometry/primitives.h"
#include "tactum/math/screw.h"
#include "tactum/mesh/make_part.h"
#include "tactum/mesh/piece_overlap.h"
#include "tactum/surface/triangle_pair.h"

namespace tactum {
namespace {

using testing::box_mesh;
using testing::icosphere;
using testing::transformed;

TEST(Deviation, NearestPointsAgreeWithEveryTriangleTried) {
  constexpr std::uint64_t kSeed = 5;
  SCOPED_TRACE(kSeed);
  Random random(kSeed);
  const TriangleMesh mesh = icosphere(2);
  const NearestOnMesh nearest(mesh);
  int triangle = 0;
  for (int i = 0; i < 500; ++i) {
    const Vec3 p(random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2));
    double best_sq = 1e300;  // the referee: triangle_distance from a triangle that is a point
    for (const Triangle& t : mesh.triangles) {
      const TrianglePoints corners = {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
      best_sq = std::min(best_sq, triangle_distance({p, p, p}, corners).distance_sq);
    }
    EXPECT_NEAR(nearest.distance(p, triangle), std::sqrt(best_sq), 1e-14);
  }
}

TEST(Deviation, ADistanceIsExactWhereItIsNotNearEnough) {
  constexpr std::uint64_t kSeed = 6;
  SCOPED_TRACE(kSeed);
  Random random(kSeed);
  const TriangleMesh mesh = icosphere(2);
  const NearestOnMesh nearest(mesh);
  int ended_early = 0;
  for (int i = 0; i < 500; ++i) {
    const Vec3 p(random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2));
    const double near_enough = random.uniform(0.0, 2.0);
    int triangle = i % static_cast<int>(mesh.triangles.size());
    int early_triangle = triangle;
    const double exact = nearest.distance(p, triangle);
    const double early = nearest.distance(p, early_triangle, near_enough);
    EXPECT_GE(early, exact);
    EXPECT_EQ(early > near_enough, exact > near_enough);
    if (exact > near_enough) {
      EXPECT_EQ(early, exact);
    }
    ended_early += early > exact ? 1 : 0;
  }
  EXPECT_GT(ended_early, 50);  // the early end is met
}

TEST(Deviation, IsNothingForAPartOfTheMeshItself) {
  TriangleMesh dented = icosphere(3);
  dented.vertices[40] *= 0.8;
  const Deviation deviation = surface_deviation(dented, *part_from_mesh(dented));
  EXPECT_LT(deviation.largest(), 1e-15 * deviation.size);
  EXPECT_GT(deviation.mesh_samples, 1000);
}

TEST(Deviation, SeesEachWayWhatIsMissing) {
  const TriangleMesh whole = icosphere(3);
  TriangleMesh less = whole;
  less.triangles.pop_back();  // a hole in the part: the mesh's samples there are far from it
  const Deviation holed = surface_deviation(whole, *part_from_mesh(less));
  EXPECT_GT(holed.mesh_to_part, 0.01);
  EXPECT_LT(holed.part_to_mesh, 1e-15);
  const Deviation filled = surface_deviation(less, *part_from_mesh(whole));
  EXPECT_LT(filled.mesh_to_part, 1e-15);
  EXPECT_GT(filled.part_to_mesh, 0.01);
}

TEST(Deviation, MeasuresAShiftExactly) {
  const TriangleMesh box = box_mesh({1, 2, 3});
  const Deviation shifted = surface_deviation(box, *part_from_mesh(box), Vec3(0.25, 0, 0));
  EXPECT_NEAR(shifted.mesh_to_part, 0.25, 1e-15);
  EXPECT_NEAR(shifted.part_to_mesh, 0.25, 1e-15);
}

TEST(Deviation, CutsInsideASolidAreNoSurface) {
  // A box as a mesh; the part is the box cut in two.
  const TriangleMesh box = box_mesh({2, 1, 1});
  const auto half = [](double x) {
    return transformed(box_mesh({1, 1, 1}), Mat3::Identity(), Vec3(x, 0, 0)).vertices;
  };
  const Result<Part> cut = part_from_clouds({half(-1), half(1)});
  const Deviation deviation = surface_deviation(box, *cut);
  EXPECT_LT(deviation.largest(), 1e-15);
  EXPECT_GT(deviation.inner_samples, 100);
  // With a gap between the halves the cut is surface, and far from the mesh.
  const Result<Part> apart = part_from_clouds({half(-1.01), half(1)});
  EXPECT_GT(surface_deviation(box, *apart).part_to_mesh, 0.4);
}

TEST(PieceOverlap, AgreesWithThePenetrationDepthOfTheContactCore) {
  constexpr std::uint64_t kSeed = 31;
  SCOPED_TRACE(kSeed);
  Random random(kSeed);
  int overlapping = 0;
  for (int i = 0; i < cases::some_of(300); ++i) {
    std::vector<Vec3> points;
    for (int k = 0; k < 12; ++k)
      points.emplace_back(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    const Polytope a = *convex_hull(points);
    for (Vec3& p : points) {
      p = exp_rotation(Vec3(random.unit(), random.unit(), random.unit())) * p;
      p += Vec3(random.uniform(0.2, 1.5), 0.3, 0.1);
    }
    const Polytope b = *convex_hull(points);
    const double found = separation(a, b, 1e300);
    const PairDistance depth = penetration_exhaustive(a, b, Pose{});
    if (depth.distance < 0.0) {
      ++overlapping;
      EXPECT_NEAR(found, depth.distance, 1e-12);
    } else {
      EXPECT_GE(found, -1e-15);
    }
  }
  EXPECT_GT(overlapping, 0);
}

TEST(PieceOverlap, PiecesThatTouchDoNotOverlapAndThoseThatOverlapAreNamed) {
  const auto cube = [](const Vec3& at) {
    return transformed(box_mesh({1, 1, 1}), Mat3::Identity(), at).vertices;
  };
  const Part touching = *part_from_clouds({cube({0, 0, 0}), cube({2, 0, 0}), cube({2, 2, 0})});
  EXPECT_EQ(overlapping_pieces(touching, 1e-12).pairs, 0);
  const Part overlapping = *part_from_clouds({cube({0, 0, 0}), cube({1.75, 0, 0}), cube({9, 0, 0})});
  const PieceOverlaps found = overlapping_pieces(overlapping, 1e-12);
  EXPECT_EQ(found.pairs, 1);
  EXPECT_EQ(found.worst, (std::array<int, 2>{0, 1}));
  EXPECT_NEAR(found.deepest, 0.25, 1e-15);
}

}  // namespace
}  // namespace tactum
