#include "tactum/parts/generated_parts.h"

#include <gtest/gtest.h>

#include "tactum/base/random.h"
#include "tactum/base/tolerances.h"

namespace tactum::generated_parts_test {
namespace {

bool inside(const Polytope& piece, const Vec3& p) {
  for (const auto& face : piece.faces)
    if (face.normal.dot(p) >= face.offset) return false;
  return true;
}

int pieces_holding(const std::vector<Polytope>& pieces, const Vec3& p) {
  int count = 0;
  for (const Polytope& piece : pieces) count += inside(piece, p) ? 1 : 0;
  return count;
}

TEST(GeneratedParts, RectangularPegIsOneBoxStandingOnItsTip) {
  const auto pieces = peg_pieces(Peg{});
  ASSERT_TRUE(pieces) << pieces.error().message();
  ASSERT_EQ(pieces->size(), 1u);
  EXPECT_EQ(pieces->front().faces.size(), 6u);
  const Aabb box = bounds(pieces->front().vertices);
  EXPECT_TRUE(box.min.isApprox(Vec3(-0.01, -0.007, 0.0)));
  EXPECT_TRUE(box.max.isApprox(Vec3(0.01, 0.007, 0.05)));
}

TEST(GeneratedParts, ChamferAndRoundPegs) {
  Peg peg;
  peg.chamfer_m = 0.001;
  EXPECT_EQ(peg_pieces(peg)->front().faces.size(), 10u);
  peg.sides = 32;
  EXPECT_EQ(peg_pieces(peg)->front().faces.size(), 66u);
  EXPECT_LT(convexity_defect(peg_pieces(peg)->front()), 4 * tolerances::kCoplanar * 0.06);
}

TEST(GeneratedParts, BlockFillsEverythingButTheHoleOnce) {
  for (const int sides : {0, 4, 24}) {
    HoleBlock block;
    block.sides = sides;
    block.floor_m = 0.005;
    const auto pieces = hole_block_pieces(block);
    ASSERT_TRUE(pieces) << pieces.error().message();
    EXPECT_EQ(pieces->size(), sides == 0 ? 5u : std::size_t(sides) + 1);
    const std::uint64_t seed = 77;
    Random random(seed);
    const double x_hole = 0.5 * (block.peg_width_m + block.clearance_m);
    const double y_hole = 0.5 * (block.peg_depth_m + block.clearance_m);
    for (int i = 0; i < 20000; ++i) {
      const double x = random.uniform(-0.05, 0.05);
      const double y = random.uniform(-0.05, 0.05);
      const double z = random.uniform(-0.01, 0.04);
      const int holding = pieces_holding(*pieces, {x, y, z});
      const bool in_hole =
          sides == 0 ? std::abs(x) < x_hole && std::abs(y) < y_hole : std::hypot(x, y) < x_hole;
      const bool near = sides == 0
                            ? std::abs(x) < x_hole + block.wall_m && std::abs(y) < y_hole + block.wall_m
                            : std::hypot(x, y) < x_hole + block.wall_m;
      const bool in_rim =
          std::hypot(x, y) > x_hole && std::hypot(x, y) < x_hole / std::cos(kPi / std::max(4, sides));
      const bool sure = sides == 0 || !in_rim;  // between the hole's circle and its corners either is right
      const bool in_height = z < block.hole_depth_m && z > -block.floor_m;
      if (!near || !in_height || !sure) {
        EXPECT_LE(holding, 1) << "seed " << seed << " sample " << i;
        continue;
      }
      EXPECT_EQ(holding, in_hole && z > 0.0 ? 0 : 1)
          << "seed " << seed << " sample " << i << " sides " << sides;
    }
  }
}

TEST(GeneratedParts, EqualPosesPutThePegIntoTheHoleWithItsClearance) {
  HoleBlock block;
  block.floor_m = 0.005;
  const auto walls = hole_block_pieces(block);
  ASSERT_TRUE(walls);
  const auto peg = peg_pieces(Peg{});
  ASSERT_TRUE(peg);
  for (const auto& corner : peg->front().vertices) {
    double nearest =
        1e300;  // largest face height of each piece, smallest over pieces: planar distance outside
    for (std::size_t i = 0; i < 4; ++i) {
      double height = -1e300;
      for (const auto& face : (*walls)[i].faces)
        height = std::max(height, face.normal.dot(corner) - face.offset);
      nearest = std::min(nearest, height);
    }
    EXPECT_GE(nearest, 0.5 * block.clearance_m - 1e-15);
  }
}

TEST(GeneratedParts, RefusesWhatCannotBe) {
  EXPECT_FALSE(peg_pieces({.width_m = 0.0}));
  EXPECT_FALSE(peg_pieces({.depth_m = -1.0}));
  EXPECT_FALSE(peg_pieces({.length_m = std::nan("")}));
  EXPECT_FALSE(peg_pieces({.chamfer_m = 0.01}));
  EXPECT_FALSE(peg_pieces({.sides = 2}));
  EXPECT_FALSE(hole_block_pieces({.wall_m = 0.0}));
  EXPECT_FALSE(hole_block_pieces({.clearance_m = -1e-6}));
  EXPECT_FALSE(hole_block_pieces({.floor_m = -1.0}));
  EXPECT_FALSE(hole_block_pieces({.sides = 1}));
}

}  // namespace
}  // namespace tactum::generated_parts_test
