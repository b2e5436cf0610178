#include "tactum/referee/crossing_referee.h"

#include <gtest/gtest.h>

#include "support/sample_meshes.h"
#include "support/surface_shapes.h"
#include "tactum/math/screw.h"
#include "tactum/referee/exact_orientation.h"
#include "tactum/referee/linking.h"
#include "tactum/referee/winding_number.h"

namespace tactum::referee_test {
namespace {

using testing::box_mesh;
using testing::icosphere;
using testing::torus;
using testing::transformed;

/// The determinant of integers, in which nothing is rounded.
int sign_in_integers(const std::array<std::array<std::int64_t, 3>, 4>& p) {
  std::int64_t m[3][3];
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) m[i][k] = p[std::size_t(i)][std::size_t(k)] - p[3][std::size_t(k)];
  const std::int64_t det = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  return det > 0 ? 1 : det < 0 ? -1 : 0;
}

/// Points of a plane, some moved by a unit in the last place: far below the rounding of the determinant.
TEST(ExactOrientation, IsThatOfIntegersThatLieInOnePlaneOrNearlySo) {
  Random random(3);
  int planar = 0, decided = 0;
  for (int i = 0; i < 20'000; ++i) {
    std::array<std::array<std::int64_t, 3>, 4> p{};
    for (std::size_t k = 0; k < 3; ++k)
      for (std::int64_t& x : p[k]) x = random.index(1 << 17);
    for (std::size_t x = 0; x < 3; ++x) p[3][x] = p[0][x] + 2 * (p[1][x] - p[0][x]) - (p[2][x] - p[0][x]);
    if (i % 3 != 0) p[3][std::size_t(random.index(3))] += random.index(3) - 1;
    std::array<Vec3, 4> q;
    for (std::size_t k = 0; k < 4; ++k)
      q[k] = Vec3(double(p[k][0]), double(p[k][1]), double(p[k][2])) * 0x1p-40;
    const int right = sign_in_integers(p);
    EXPECT_EQ(orientation(q[0], q[1], q[2], q[3]), right);
    EXPECT_EQ(orientation(q[1], q[0], q[2], q[3]), -right);
    ++(right == 0 ? planar : decided);
  }
  EXPECT_GT(planar, 5000);
  EXPECT_GT(decided, 5000);
}

TEST(MeshLoops, AreTwiceAsManyAsASurfaceHasHoles) {
  EXPECT_TRUE(mesh_loops(icosphere(2)).empty());
  EXPECT_TRUE(mesh_loops(box_mesh({1, 1, 1})).empty());
  EXPECT_EQ(mesh_loops(torus(12, 6, 0.02, 0.003)).size(), 2u);
  EXPECT_EQ(mesh_loops(torus(40, 25, 0.02, 0.003)).size(), 2u);
  const TriangleMesh two = testing::joined(
      torus(12, 6, 0.02, 0.003), transformed(torus(8, 8, 0.02, 0.003), Mat3::Identity(), {0.1, 0, 0}));
  EXPECT_EQ(mesh_loops(two).size(), 4u);
}

TEST(Linking, OfRoundLinesIsHowOftenOneGoesThroughTheOther) {
  const auto circle = [](int corners, int turns) {
    ClosedLine line;
    for (int i = 0; i < corners * turns; ++i) {
      const double angle = 2.0 * kPi * i / corners;
      const double away = 0.001 * i / corners;  // so that it does not meet itself
      line.push_back({(0.02 + away) * std::cos(angle), (0.02 + away) * std::sin(angle), 0.0});
    }
    return line;
  };
  const Pose square{exp_rotation({0.5 * kPi, 0, 0}), {0.02, 0, 0}};
  for (const int corners : {3, 7, 32}) {
    const ClosedLine once = circle(corners, 1);
    EXPECT_NEAR(std::abs(linking_number(once, circle(31, 1), square)), 1.0, 1e-9);
    EXPECT_NEAR(linking_number(once, circle(31, 1), {square.R, {0.05, 0, 0}}), 0.0, 1e-9);
    EXPECT_NEAR(linking_number(once, once, {Mat3::Identity(), {0, 0, 0.01}}), 0.0, 1e-9);
  }
  EXPECT_NEAR(std::abs(linking_number(circle(31, 2), circle(32, 1), square)), 2.0, 1e-9);
}

TEST(WindingNumber, IsOneInsideAndNoneOutside) {
  const TriangleMesh ring = torus(24, 12, 0.02, 0.003);
  EXPECT_NEAR(winding_number(ring, {0.02, 0, 0}), 1.0, 1e-12);
  EXPECT_NEAR(winding_number(ring, {0, 0, 0}), 0.0, 1e-12);
  EXPECT_NEAR(winding_number(ring, {0.03, 0, 0.001}), 0.0, 1e-12);
}

/// Bodies of which the first is fixed.
CrossingReferee referee_of(const std::vector<const TriangleMesh*>& meshes, const std::vector<Pose>& start) {
  std::vector<RefereedBody> bodies;
  for (const TriangleMesh* mesh : meshes) bodies.push_back({mesh, !bodies.empty(), -1});
  return {bodies, start};
}

/// A ring that hangs in another one, at an angle and elsewhere.
Pose hanging(double turn, double aside) {
  return {exp_rotation({0.5 * kPi, 0, 0}) * exp_rotation({0, turn, 0}), {0.02 + aside, 0, aside}};
}

TEST(CrossingReferee, SeesWiresThatCrossAndRingsThatHaveComeLoose) {
  const TriangleMesh ring = torus(32, 12, 0.02, 0.003);
  const std::vector<Pose> start{Pose(), hanging(0.0, 0.0)};
  const CrossingReferee referee = referee_of({&ring, &ring}, start);
  EXPECT_EQ(referee.crossing_at_start(), 0);
  EXPECT_TRUE(referee.judge(start).empty());
  for (const double turn : {-0.6, -0.2, 0.3})
    EXPECT_TRUE(referee.judge(std::vector<Pose>{Pose(), hanging(turn, 0.004)}).empty()) << turn;
  const auto crossing = referee.judge(std::vector<Pose>{Pose(), {start[1].R, {0.038, 0, 0}}});
  ASSERT_EQ(crossing.size(), 1u);
  EXPECT_TRUE(crossing[0].surfaces_cross);
  for (const double away : {0.05, 0.2}) {  // near enough for the boxes to meet, and far
    const auto loose = referee.judge(std::vector<Pose>{Pose(), {start[1].R, {away, 0, 0}}});
    ASSERT_EQ(loose.size(), 1u) << away;
    EXPECT_FALSE(loose[0].surfaces_cross);
    EXPECT_TRUE(loose[0].links_changed);
  }
}

TEST(CrossingReferee, SeesRingsThatBeganApartAndHangInEachOther) {
  const TriangleMesh ring = torus(32, 12, 0.02, 0.003);
  const CrossingReferee referee = referee_of({&ring, &ring}, {Pose(), {hanging(0, 0).R, {0.06, 0, 0}}});
  const auto linked = referee.judge(std::vector<Pose>{Pose(), hanging(0.2, 0.0)});
  ASSERT_EQ(linked.size(), 1u);
  EXPECT_TRUE(linked[0].links_changed);
}

TEST(CrossingReferee, SeesWhatHasGotInsideOrOut) {
  const TriangleMesh cup = box_mesh({0.05, 0.05, 0.05});
  const TriangleMesh ball = transformed(icosphere(1), 0.01 * Mat3::Identity(), Vec3::Zero());
  const Pose outside{Mat3::Identity(), {0.08, 0, 0}};
  const CrossingReferee from_outside = referee_of({&cup, &ball}, {Pose(), outside});
  const auto in = from_outside.judge(std::vector<Pose>{Pose(), Pose()});
  ASSERT_EQ(in.size(), 1u);
  EXPECT_TRUE(in[0].inside);
  const CrossingReferee from_inside = referee_of({&cup, &ball}, {Pose(), Pose()});
  EXPECT_TRUE(from_inside.judge(std::vector<Pose>{Pose(), {Mat3::Identity(), {0.02, 0, 0}}}).empty());
  const auto out = from_inside.judge(std::vector<Pose>{Pose(), outside});
  ASSERT_EQ(out.size(), 1u);
  EXPECT_TRUE(out[0].inside);
}

TEST(CrossingReferee, DoesNotCallTouchingCrossingAndLeavesOutWhatCrossesAtTheStart) {
  const TriangleMesh box = box_mesh({0.5, 0.5, 0.5});
  const CrossingReferee referee = referee_of({&box, &box}, {Pose(), {Mat3::Identity(), {0, 0, 2}}});
  EXPECT_TRUE(referee.judge(std::vector<Pose>{Pose(), {Mat3::Identity(), {0.25, 0, 1.0}}}).empty());
  EXPECT_FALSE(referee.judge(std::vector<Pose>{Pose(), {Mat3::Identity(), {0.25, 0.125, 0.999}}}).empty());
  const CrossingReferee crossed = referee_of({&box, &box}, {Pose(), {Mat3::Identity(), {0.25, 0.125, 0.9}}});
  EXPECT_EQ(crossed.crossing_at_start(), 1);
  EXPECT_TRUE(crossed.judge(std::vector<Pose>{Pose(), {Mat3::Identity(), {0.25, 0.125, 0.9}}}).empty());
}

}  // namespace
}  // namespace tactum::referee_test
