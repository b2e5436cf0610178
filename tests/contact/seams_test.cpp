/// Contacts that are settled between the pieces of one part.

#include "tactum/contact/seams.h"

#include <gtest/gtest.h>

#include "support/effort.h"
#include "tactum/contact/contact_finder.h"
#include "tactum/geometry/primitives.h"
#include "tactum/math/screw.h"
#include "tactum/mesh/make_part.h"

namespace tactum {
namespace {

Part part_of(const std::vector<std::vector<Vec3>>& clouds) {
  Result<Part> part = part_from_clouds(clouds);
  EXPECT_TRUE(part);
  return std::move(*part);
}

std::vector<Vec3> box_between(const Vec3& low, const Vec3& high) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i)
    corners.emplace_back(i & 1 ? high.x() : low.x(), i & 2 ? high.y() : low.y(), i & 4 ? high.z() : low.z());
  return corners;
}

/// Patches of a block of 20 x 20 x 10 mm at X over a part.
std::vector<ContactPatch> patches_on(const Part& part, const Pose& X, double tolerance) {
  const Part block = part_of({make_box({0.01, 0.01, 0.005}).vertices});
  const std::vector<Pose> poses = {X, Pose{}};
  ContactFinder finder({{&block, true}, {&part, false}}, poses);
  const std::vector<double> motion_bound = {tolerance, 0.0};
  finder.find_near_pairs(poses, motion_bound, tolerance);
  finder.find_patches(poses, 1000);
  return {finder.patches().begin(), finder.patches().end()};
}

/// Two tiles with a common wall at x = 0, tops at z = 0.
Part tiles() {
  return part_of(
      {box_between({-0.05, -0.05, -0.02}, {0, 0.05, 0}), box_between({0, -0.05, -0.02}, {0.05, 0.05, 0})});
}

TEST(Seams, AFlatContactOverASeamIsOne) {
  const Part part = tiles();
  for (double gap : {2e-4, 0.0, -3e-4}) {
    // The block extends only 50 um over the seam: the penetration depth of the right tile is sideways.
    for (double x : {0.0, -0.00995, 0.004}) {
      const std::vector<ContactPatch> patches =
          patches_on(part, {Mat3::Identity(), {x, 0, 0.005 + gap}}, 1e-3);
      ASSERT_EQ(patches.size(), 1u) << gap << " " << x;
      const Manifold& patch = patches[0].manifold;
      EXPECT_LT((patch.normal - Vec3::UnitZ()).norm(), 1e-12);
      EXPECT_NEAR(patches[0].distance, gap, 1e-12);
      EXPECT_NEAR(patch.area, 4e-4, 1e-12);
      // The moments of the block's whole face, 20 x 20 mm, which is A's.
      Vec3 centroid = Vec3::Zero();
      double xx = 0.0;
      for (const ContactPoint& point : patch.points) centroid += point.weight * point.p_a;
      for (const ContactPoint& point : patch.points)
        xx += point.weight * (point.p_a.x() - centroid.x()) * (point.p_a.x() - centroid.x());
      EXPECT_LT(centroid.head<2>().norm(), 1e-12);
      EXPECT_NEAR(xx, 0.02 * 0.02 / 12, 1e-12);
    }
  }
}

TEST(Seams, BesideATileItsWallIsNotFelt) {
  // Over the left tile, below its top, and a hair from the wall of the right one.
  const std::vector<ContactPatch> patches =
      patches_on(tiles(), {Mat3::Identity(), {-0.01005, 0, 0.0048}}, 1e-3);
  ASSERT_EQ(patches.size(), 1u);
  EXPECT_EQ(patches[0].piece_b, 0);
  EXPECT_LT((patches[0].manifold.normal - Vec3::UnitZ()).norm(), 1e-12);
}

TEST(Seams, ATrueCornerBetweenPiecesHasBothContacts) {
  // An inner corner: a floor and a wall, each a piece.
  const Part part = part_of({box_between({-0.05, -0.05, -0.02}, {0.05, 0.05, 0}),
                             box_between({0.03, -0.05, 0}, {0.05, 0.05, 0.04})});
  const std::vector<ContactPatch> patches = patches_on(part, {Mat3::Identity(), {0.0202, 0, 0.0049}}, 1e-3);
  ASSERT_EQ(patches.size(), 2u);
  EXPECT_NE(patches[0].facets.b, patches[1].facets.b);
  double up = 0.0;
  double side = 0.0;
  for (const ContactPatch& patch : patches) {
    up = std::max(up, patch.manifold.normal.z());
    side = std::max(side, -patch.manifold.normal.x());
  }
  EXPECT_NEAR(up, 1.0, 1e-12);
  EXPECT_NEAR(side, 1.0, 1e-12);
}

/// The turns that put axes on axes: after each a box's features are numbered another way.
std::vector<Mat3> turns_of_a_box() {
  std::vector<Mat3> turns;
  for (int x = 0; x < 3; ++x)
    for (int y = 0; y < 3; ++y)
      for (int signs = 0; x != y && signs < 4; ++signs) {
        Mat3 turn = Mat3::Zero();
        turn(x, 0) = signs & 1 ? -1.0 : 1.0;
        turn(y, 1) = signs & 2 ? -1.0 : 1.0;
        turn.col(2) = turn.col(0).cross(turn.col(1));
        turns.push_back(turn);
      }
  return turns;
}

TEST(Seams, InACornerThatIsEnteredBothWaysOutAreTold) {
  // The wall goes down beside the floor: the block's lowest corners are where the floor covers the wall.
  for (const Mat3& turn : testing::sampled(turns_of_a_box(), 5)) {
    const auto turned_box = [&](const Vec3& low, const Vec3& high) {
      std::vector<Vec3> corners = box_between(low, high);
      for (Vec3& corner : corners) corner = turn * corner;
      return corners;
    };
    const Part part = part_of({turned_box({-0.05, -0.05, -0.02}, {0.03, 0.05, 0}),
                               turned_box({0.03, -0.05, -0.02}, {0.05, 0.05, 0.04})});
    for (const double into_floor : {1e-4, 3e-4, 2e-3}) {
      for (const double into_wall : {1e-4, 2e-4, 1e-3}) {
        const Pose X{turn, turn * Vec3(0.02 + into_wall, 0, 0.005 - into_floor)};
        double up = 1.0;
        double side = 1.0;
        const std::vector<ContactPatch> patches = patches_on(part, X, 1e-4);
        EXPECT_EQ(patches.size(), 2u);
        for (const ContactPatch& patch : patches) {
          if (patch.manifold.normal.z() > 0.999) up = patch.distance;
          if (patch.manifold.normal.x() < -0.999) side = patch.distance;
        }
        EXPECT_NEAR(up, -into_floor, 1e-9) << into_wall << "\n" << turn;
        EXPECT_NEAR(side, -into_wall, 1e-9) << into_floor << "\n" << turn;
      }
    }
  }
}

TEST(Seams, NeighboursObjectToWhatIsInsideThePart) {
  const Part part = tiles();
  const Polytope& left = part.pieces[0];
  int top = -1;
  int wall = -1;
  for (int f = 0; f < left.counts[2]; ++f) {
    if (left.faces[f].normal.z() > 0.5) top = f;
    if (left.faces[f].normal.x() > 0.5) wall = f;
  }
  EXPECT_TRUE(allowed_by_neighbours(part, 0, {FeatureKind::kFace, top}, {-0.01, 0, 0}, Vec3::UnitZ()));
  EXPECT_FALSE(allowed_by_neighbours(part, 0, {FeatureKind::kFace, wall}, {0, 0, -0.01}, Vec3::UnitX()));
  for (int e = 0; e < left.counts[1]; ++e) {
    const Polytope::Edge& edge = left.edges[e];
    const bool seam = (edge.left == top && edge.right == wall) || (edge.left == wall && edge.right == top);
    if (!seam) continue;
    const Vec3 middle = 0.5 * (left.vertices[edge.tail] + left.vertices[edge.head]);
    EXPECT_TRUE(allowed_by_neighbours(part, 0, {FeatureKind::kEdge, e}, middle, Vec3::UnitZ()));
    EXPECT_FALSE(
        allowed_by_neighbours(part, 0, {FeatureKind::kEdge, e}, middle, Vec3(0.1, 0, 1).normalized()));
  }
}

}  // namespace
}  // namespace tactum
