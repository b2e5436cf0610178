#include "viewer/server/shape_edges.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tactum/mesh/make_part.h"

namespace tactum {
namespace {

std::vector<Vec3> box(const Vec3& from, const Vec3& to) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i)
    corners.emplace_back((i & 1) != 0 ? to.x() : from.x(), (i & 2) != 0 ? to.y() : from.y(),
                         (i & 4) != 0 ? to.z() : from.z());
  return corners;
}

TEST(ShapeEdges, SeamsBetweenPiecesAreNotDrawn) {
  // A bar of two cubes: twelve edges of the whole, in pieces; the four around the seam are no edges.
  const Result<Part> bar = part_from_clouds({box({0, 0, 0}, {1, 1, 1}), box({1, 0, 0}, {2, 1, 1})});
  ASSERT_TRUE(bar);
  const std::vector<DrawnEdge> edges = edges_to_draw(*bar);
  EXPECT_EQ(edges.size(), 16u);  // 4 + 4 at the ends, 4 + 4 halves along
  for (const DrawnEdge& edge : edges)
    EXPECT_FALSE(std::abs(edge.tail.x() - 1.0) < 1e-9 && std::abs(edge.head.x() - 1.0) < 1e-9);
  const std::vector<bool> covered = covered_triangles(*bar);
  EXPECT_EQ(covered.size(), 24u);
  EXPECT_EQ(std::count(covered.begin(), covered.end(), true), 4);  // two a face, on either side
}

/// A wall that stands on a slab: where they meet the part bends inward, and neither piece does.
TEST(ShapeEdges, WhereTwoPiecesBendInwardTheyAreReflex) {
  const Result<Part> bracket = part_from_clouds({box({0, 0, 0}, {3, 1, 1}), box({0, 0, 1}, {1, 1, 2})});
  ASSERT_TRUE(bracket);
  int reflex = 0;
  for (const DrawnEdge& edge : edges_to_draw(*bracket)) {
    const bool inner = std::abs(edge.tail.x() - 1.0) + std::abs(edge.head.x() - 1.0) +
                           std::abs(edge.tail.z() - 1.0) + std::abs(edge.head.z() - 1.0) <
                       1e-9;
    EXPECT_EQ(edge.kind == EdgeKind::kReflex, inner);
    reflex += edge.kind == EdgeKind::kReflex ? 1 : 0;
  }
  EXPECT_EQ(reflex, 1);
}

/// The edges of a slab that are seams where walls stand flush on its sides, and sharp elsewhere: the drawn
/// length is that of the whole shape's edges, at any size and number of walls.
TEST(ShapeEdges, SeamsAlongPartOfAnEdgeAreNotDrawn) {
  for (const double unit : {0.001, 0.01, 1.0}) {
    for (const int walls : {0, 1, 2, 3}) {
      std::vector<std::vector<Vec3>> clouds = {box({0, 0, 0}, unit * Vec3(7, 1, 1))};
      for (int i = 0; i < walls; ++i)
        clouds.push_back(box(unit * Vec3(2 * i + 1, 0, 1), unit * Vec3(2 * i + 2, 1, 3)));
      const Result<Part> comb = part_from_clouds(clouds);
      ASSERT_TRUE(comb);
      double sharp = 0.0, reflex = 0.0;
      for (const DrawnEdge& edge : edges_to_draw(*comb)) {
        const double length = (edge.head - edge.tail).norm() / unit;
        (edge.kind == EdgeKind::kSharp ? sharp : reflex) += length;
        EXPECT_LT(edge.kind == EdgeKind::kSharp ? 0.0 : std::abs(edge.tail.z() / unit - 1.0), 1e-6);
      }
      // A wall adds its upright and upper edges, takes its foot from the slab's, and has two reflex ones.
      EXPECT_NEAR(sharp, 4 * 7 + 4 + 4 + walls * (4 * 2 + 4 - 2.0), 1e-6) << walls;
      EXPECT_NEAR(reflex, walls * 2.0, 1e-6) << walls;
    }
  }
}

}  // namespace
}  // namespace tactum
