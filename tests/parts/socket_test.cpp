#include "tactum/parts/socket.h"

#include <gtest/gtest.h>

#include <cmath>

#include "oracles/exhaustive.h"
#include "scene/filling.h"
#include "tactum/base/random.h"
#include "tactum/base/tolerances.h"

namespace tactum::socket_test {
namespace {

double hexagon_area(double across_flats) { return 0.5 * std::sqrt(3.0) * across_flats * across_flats; }

/// How far a point lies outside a hexagon about the axis with flats across y; negative inside.
double outside_hexagon(double u, double v, double across_flats) {
  double most = -1e300;
  for (const double degrees : {30.0, 90.0, 150.0}) {
    const double angle = degrees * kPi / 180.0;
    most = std::max(most, std::abs(u * std::cos(angle) + v * std::sin(angle)) - 0.5 * across_flats);
  }
  return most;
}

TEST(HexKey, IsTwoPrismsThatMeetInTheCorner) {
  const HexKey key;
  const auto pieces = hex_key_pieces(key);
  ASSERT_TRUE(pieces) << pieces.error().message();
  ASSERT_EQ(pieces->size(), 2u);
  Aabb box;
  for (const Polytope& piece : *pieces) {
    EXPECT_EQ(piece.vertices.size(), 12u);
    EXPECT_EQ(piece.faces.size(), 8u);
    EXPECT_LT(convexity_defect(piece), 4 * tolerances::kCoplanar * piece.extent.size);
    box.extend(bounds(piece.vertices));
  }
  const double radius = key.across_flats_m / std::sqrt(3.0);
  EXPECT_NEAR((box.min - Vec3(-radius, -0.5 * key.across_flats_m, 0.0)).norm(), 0.0, 1e-15);
  EXPECT_NEAR((box.max - Vec3(key.long_m - radius, 0.5 * key.across_flats_m, key.short_m)).norm(), 0.0,
              1e-15);
  // The arms' middle lines add up: the plane between them halves the corner.
  const double line = key.short_m - radius + key.long_m - radius;
  EXPECT_NEAR(filling::volume(*pieces) / (hexagon_area(key.across_flats_m) * line), 1.0, 1e-12);
}

TEST(HexKey, ArmsFillTheirHexagonsOnce) {
  const HexKey key;
  const auto pieces = *hex_key_pieces(key);
  const double radius = key.across_flats_m / std::sqrt(3.0);
  const double bend = key.short_m - radius;
  const std::uint64_t seed = 5;
  Random random(seed);
  int inside = 0;
  for (int i = 0; i < 20000; ++i) {
    const double x = random.uniform(-1.2 * radius, 4.0 * radius);
    const double y = random.uniform(-1.2 * radius, 1.2 * radius);
    const double z = random.uniform(bend - 4.0 * radius, bend + 1.2 * radius);
    const bool below = x + z < bend;  // the plane between the arms
    const bool expected = below ? outside_hexagon(x, y, key.across_flats_m) < 0.0
                                : outside_hexagon(z - bend, y, key.across_flats_m) < 0.0;
    EXPECT_EQ(filling::pieces_holding(pieces, {x, y, z}), expected ? 1 : 0)
        << "seed " << seed << " sample " << i;
    inside += expected ? 1 : 0;
  }
  EXPECT_GT(inside, 3000);
}

TEST(HexSocket, IsARoundHeadWithAHexagonalHole) {
  for (const int facets : {1, 4, 9}) {
    HexSocket socket;
    socket.facets_per_side = facets;
    const auto pieces = hex_socket_pieces(socket);
    ASSERT_TRUE(pieces) << pieces.error().message();
    EXPECT_EQ(pieces->size(), 7u);
    const double angle = 2.0 * kPi / (6 * facets);
    const double head = 0.5 * 6 * facets * std::sin(angle) * std::pow(0.5 * socket.diameter_m, 2);
    const double hole = hexagon_area(socket.across_flats_m + socket.clearance_m);
    EXPECT_NEAR(filling::volume(*pieces) / ((head - hole) * socket.depth_m + head * socket.floor_m), 1.0,
                1e-12);
    for (const Polytope& piece : *pieces)
      EXPECT_LT(convexity_defect(piece), 4 * tolerances::kCoplanar * 0.015);

    const std::uint64_t seed = 6;
    Random random(seed);
    for (int i = 0; i < 10000; ++i) {
      const double x = random.uniform(-0.007, 0.007);
      const double y = random.uniform(-0.007, 0.007);
      const double z = random.uniform(-0.005, 0.005);
      const bool in_hole = outside_hexagon(x, y, socket.across_flats_m + socket.clearance_m) < 0.0 && z > 0.0;
      const bool in_height = z > -socket.floor_m && z < socket.depth_m;
      const double radius = std::hypot(x, y);
      if (radius > 0.5 * socket.diameter_m * std::cos(0.5 * angle) && radius < 0.5 * socket.diameter_m)
        continue;
      const bool solid = in_height && !in_hole && radius < 0.5 * socket.diameter_m;
      EXPECT_EQ(filling::pieces_holding(*pieces, {x, y, z}), solid ? 1 : 0)
          << "seed " << seed << " sample " << i;
    }
  }
}

TEST(HexSocket, EqualPosesPutTheKeyInWithHalfTheClearanceOnEitherSide) {
  const HexSocket socket;
  const auto walls = *hex_socket_pieces(socket);
  const auto key = *hex_key_pieces(HexKey{});
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_NEAR(static_cast<double>(oracle::feature_distance(walls[i], key[0], Pose{})),
                0.5 * socket.clearance_m, 1e-12)
        << "wall " << i;
  EXPECT_NEAR(static_cast<double>(oracle::axes_separation(walls[6], key[0], Pose{})), 0.0,
              1e-12);  // the floor
}

TEST(Socket, RefusesWhatCannotBe) {
  EXPECT_NE(hex_key_pieces({.across_flats_m = 0.0}).error().message().find("width across flats"),
            std::string::npos);
  EXPECT_NE(hex_key_pieces({.short_m = 0.005}).error().message().find("short arm"), std::string::npos);
  EXPECT_NE(hex_key_pieces({.long_m = std::nan("")}).error().message().find("long arm"), std::string::npos);
  EXPECT_FALSE(hex_socket_pieces({.across_flats_m = -1.0}));
  EXPECT_FALSE(hex_socket_pieces({.clearance_m = -1e-6}));
  EXPECT_NE(hex_socket_pieces({.diameter_m = 0.007}).error().message().find("across corners"),
            std::string::npos);
  EXPECT_FALSE(hex_socket_pieces({.depth_m = 0.0}));
  EXPECT_FALSE(hex_socket_pieces({.floor_m = -1.0}));
  EXPECT_FALSE(hex_socket_pieces({.facets_per_side = 0}));
  EXPECT_EQ(hex_socket_pieces({.floor_m = 0.0})->size(), 6u);
}

}  // namespace
}  // namespace tactum::socket_test
