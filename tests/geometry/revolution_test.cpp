// Circles about an axis, and balls, are found in meshes of turned parts at any place, size and turn, and in
// no others.

#include "tactum/geometry/revolution.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "support/sample_meshes.h"
#include "tactum/geometry/round_piece.h"
#include "tactum/math/pose.h"
#include "tactum/math/screw.h"

namespace tactum::revolution_test {
namespace {

constexpr double kCrease = 0.6;  // [rad]

/// A ring about z, closed: an outline of (radius, height), counter-clockwise with z up; `radius_at` may make
/// a radius depend on the number of the side.
template <class RadiusAt>
TriangleMesh turned(const std::vector<std::array<double, 2>>& outline, int sides, const RadiusAt& radius_at) {
  TriangleMesh mesh;
  const int rows = static_cast<int>(outline.size());
  for (int row = 0; row < rows; ++row)
    for (int k = 0; k < sides; ++k) {
      const double angle = 2.0 * kPi * k / sides;
      const double radius = radius_at(outline[std::size_t(row)][0], k);
      mesh.vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle),
                                 outline[std::size_t(row)][1]);
    }
  for (int row = 0; row < rows; ++row)
    for (int k = 0; k < sides; ++k) {
      const int next = (k + 1) % sides;
      const int above = (row + 1) % rows;
      mesh.triangles.push_back({row * sides + k, row * sides + next, above * sides + next});
      mesh.triangles.push_back({row * sides + k, above * sides + next, above * sides + k});
    }
  return mesh;
}
TriangleMesh turned(const std::vector<std::array<double, 2>>& outline, int sides) {
  return turned(outline, sides, [](double radius, int) { return radius; });
}
const std::vector<std::array<double, 2>> kTube{{1.0, -0.7}, {1.0, 0.7}, {0.6, 0.7}, {0.6, -0.7}};

TriangleMesh placed(TriangleMesh mesh, double scale, const Pose& X) {
  for (Vec3& vertex : mesh.vertices) vertex = X * Vec3(scale * vertex);
  return mesh;
}
const std::array<Pose, 3>& places() {
  static const std::array<Pose, 3> poses{Pose{}, Pose{exp_rotation({0.3, -1.1, 0.7}), {0.4, -2.0, 0.1}},
                                         Pose{exp_rotation({kPi / 2, 0, 0}), {0, 0, 1}}};
  return poses;
}

TEST(Revolution, ATubeHasTheCirclesOfItsOutside) {
  for (const int sides : {12, 33, 200})
    for (const double scale : {1e-3, 1.0, 40.0})
      for (const Pose& X : places()) {
        SCOPED_TRACE(::testing::Message() << sides << " sides, " << scale << " m");
        const TriangleMesh mesh = placed(turned(kTube, sides), scale, X);
        const Revolution found = find_revolution(mesh, kCrease);
        ASSERT_EQ(found.circles.size(), 2U);
        EXPECT_LT(std::min((found.axis - X.R.col(2)).norm(), (found.axis + X.R.col(2)).norm()), 1e-6);
        EXPECT_LT((found.center - X.p).norm(), 1e-7 * (scale + X.p.norm()));
        EXPECT_NEAR(found.bulge_m, scale * (1.0 - std::cos(kPi / sides)), 1e-7 * scale);
        for (const Revolution::Circle& circle : found.circles) {
          EXPECT_NEAR(circle.radius_m, scale, 1e-7 * scale);
          EXPECT_NEAR(circle.from_m, -0.7 * scale, 1e-6 * scale);
          EXPECT_NEAR(circle.to_m, 0.7 * scale, 1e-6 * scale);
        }
        for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
          EXPECT_EQ(found.circle_of[v] >= 0, v < std::size_t(2 * sides)) << v;
      }
}

TEST(Revolution, AConeHasCirclesWithoutACylinder) {
  const Revolution found =
      find_revolution(turned({{1.0, 0.0}, {0.5, 1.0}, {0.3, 1.0}, {0.3, 0.0}}, 40), kCrease);
  ASSERT_EQ(found.circles.size(), 2U);
  for (const Revolution::Circle& circle : found.circles) EXPECT_EQ(circle.from_m, circle.to_m);
}

TEST(Revolution, OtherMeshesHaveNone) {
  const auto none = [](const TriangleMesh& mesh) { return find_revolution(mesh, kCrease).circles.empty(); };
  EXPECT_TRUE(none(turned(kTube, 6))) << "a nut";
  EXPECT_TRUE(none(turned(kTube, 10))) << "sides that meet at more than the crease";
  EXPECT_TRUE(none(testing::box_mesh({1, 2, 3})));
  const auto toothed = [](double radius, int k) { return radius > 0.8 && k % 4 >= 2 ? 0.9 : radius; };
  EXPECT_TRUE(none(turned(kTube, 160, toothed))) << "a gear: its tips are no circle";
  EXPECT_FALSE(none(turned(kTube, 160))) << "the same without teeth";
  TriangleMesh dented = turned(kTube, 40);
  dented.vertices[3] *= 0.99;
  EXPECT_TRUE(none(dented));
}

TEST(Revolution, ABallIsFoundWhereAllItsFacetsAre) {
  for (const Pose& X : places())
    for (const double scale : {1e-3, 1.0}) {
      const RoundPiece ball = find_ball(placed(testing::icosphere(2), scale, X), kCrease);
      ASSERT_EQ(ball.kind, RoundKind::kSphere);
      EXPECT_NEAR(ball.radius_m, scale, 1e-9 * scale);
      EXPECT_LT((ball.center - X.p).norm(), 1e-9 * (scale + X.p.norm()));
      EXPECT_GT(ball.bulge_m, 0.0);
    }
  TriangleMesh finer = testing::icosphere(3);  // on one side: its mean is not its centre
  for (Vec3& vertex : finer.vertices)
    vertex = (vertex + Vec3(0.3 * (1.0 - vertex.z()), 0, 0.4 * vertex.x())).normalized();
  EXPECT_EQ(find_ball(finer, kCrease).kind, RoundKind::kSphere);
  EXPECT_EQ(find_ball(testing::icosphere(0), kCrease).kind, RoundKind::kNone) << "an icosahedron";
  EXPECT_EQ(find_ball(testing::box_mesh({1, 1, 1}), kCrease).kind, RoundKind::kNone);
  TriangleMesh half = testing::icosphere(2);
  half.triangles.resize(half.triangles.size() / 2);
  EXPECT_EQ(find_ball(half, kCrease).kind, RoundKind::kNone) << "an open one";
  TriangleMesh dented = testing::icosphere(2);
  dented.vertices[7] *= 0.999;
  EXPECT_EQ(find_ball(dented, kCrease).kind, RoundKind::kNone);
}

}  // namespace
}  // namespace tactum::revolution_test
