#include "tactum/geometry/hull.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tactum/base/random.h"
#include "tactum/base/tolerances.h"
#include "tactum/geometry/primitives.h"
#include "tactum/math/screw.h"

namespace tactum::hull_test {
namespace {

Vec3 random_vector(Random& random, double size) {
  const double x = random.uniform(-size, size);
  const double y = random.uniform(-size, size);
  const double z = random.uniform(-size, size);
  return {x, y, z};
}

void expect_sound(const Polytope& P, double size) {
  EXPECT_EQ(P.vertices.size() + P.faces.size(), P.edges.size() + 2);
  EXPECT_LT(convexity_defect(P), 4 * tolerances::kCoplanar * size);
  for (const auto& face : P.faces)  // every loop corner in its plane
    for (int i = face.first; i < face.first + face.count; ++i)
      EXPECT_NEAR(face.normal.dot(P.vertices[std::size_t(P.face_vertices[std::size_t(i)])]), face.offset,
                  4 * tolerances::kCoplanar * size);
  for (std::size_t f = 0; f < P.faces.size();
       ++f)  // a face and that across its edge lie at the edge's two sides
    for (int i = P.faces[f].first; i < P.faces[f].first + P.faces[f].count; ++i) {
      const Polytope::Edge& edge = P.edges[std::size_t(P.sides[std::size_t(i)].edge)];
      const Polytope::Side& side = P.sides[std::size_t(i)];
      const int across = side.across;
      EXPECT_TRUE(edge.left == int(f) ? edge.right == across : edge.right == int(f) && edge.left == across);
      EXPECT_EQ(side.first, P.faces[std::size_t(across)].first);
      EXPECT_EQ(side.count, P.faces[std::size_t(across)].count);
    }
  for (std::size_t v = 0; v < P.vertices.size(); ++v) EXPECT_GE(P.rays_at(int(v)).size(), P.flat ? 2u : 3u);
}

TEST(Polytope, KnowsWhichFacesAreRectangles) {
  const auto rectangles = [](const Polytope& P) {
    return std::count_if(P.faces.begin(), P.faces.end(), [](const auto& face) { return face.rectangle; });
  };
  EXPECT_EQ(rectangles(make_box({0.02, 0.03, 0.01})), 6);
  EXPECT_EQ(rectangles(make_prism(5, 0.02, 0.02)), 5);
  EXPECT_EQ(rectangles(*convex_hull({{0, 0, 0}, {1, 0, 0}, {1, 2, 0}, {0, 2, 0}})), 2);
  EXPECT_EQ(rectangles(*convex_hull({{0, 0, 0}, {1, 0, 0}, {1.001, 2, 0}, {0, 2, 0}})), 0);
  EXPECT_EQ(rectangles(*convex_hull({{0, 0, 0}, {1, 0, 0}, {2, 1, 0}, {1, 1, 0}})), 0);
}

TEST(Hull, TurnedBoxHasEightCornersAndSixFaces) {
  Random random(11);
  for (int i = 0; i < 500; ++i) {
    const Pose X{exp_rotation(random_vector(random, 3)), random_vector(random, 1)};
    std::vector<Vec3> points;
    for (int x = 0; x <= 3; ++x)
      for (int y = 0; y <= 2; ++y)
        for (int z = 0; z <= 2; ++z) points.push_back(X * Vec3(0.01 * x, 0.02 * y, 0.05 * z));
    const Result<Polytope> P = convex_hull(points);
    ASSERT_TRUE(P) << P.error().message();
    EXPECT_EQ(P->vertices.size(), 8u) << i;
    EXPECT_EQ(P->faces.size(), 6u) << i;
    expect_sound(*P, 0.2);
  }
}

TEST(Hull, ShapesAreSound) {
  EXPECT_EQ(make_prism(64, 0.01, 0.05).faces.size(), 66u);
  EXPECT_EQ(make_icosphere(2, 0.01).vertices.size(), 162u);
  EXPECT_EQ(make_icosphere(2, 0.01).faces.size(), 320u);
  expect_sound(make_prism(64, 0.01, 0.05), 0.06);
  expect_sound(make_icosphere(3, 0.02), 0.04);
  expect_sound(make_ellipsoid(3, {0.05, 0.001, 0.02}), 0.1);
}

TEST(Hull, RandomCloudsAreSoundAndSupportMatchesScan) {
  Random random(12);
  for (int i = 0; i < 300; ++i) {
    std::vector<Vec3> points;
    const int n = 4 + random.index(200);
    for (int k = 0; k < n; ++k) points.push_back(random_vector(random, 0.1));
    const Result<Polytope> P = convex_hull(points);
    ASSERT_TRUE(P) << P.error().message();
    expect_sound(*P, 0.3);
    for (int k = 0; k < 50; ++k) {
      const Vec3 d = random_vector(random, 1).normalized();
      double best = -1;
      for (const Vec3& p : points) best = std::max(best, d.dot(p));
      EXPECT_NEAR(d.dot(P->vertices[std::size_t(support_vertex(*P, d))]), best, 1e-15);
    }
  }
}

TEST(Hull, FlatAndThinPoints) {
  const Result<Polytope> square =
      convex_hull({{0, 0, 1}, {1, 0, 1}, {0.5, 0, 1}, {1, 1, 1}, {0, 1, 1}, {0.4, 0.4, 1}});
  ASSERT_TRUE(square) << square.error().message();
  EXPECT_TRUE(square->flat);
  EXPECT_EQ(square->vertices.size(), 4u);
  EXPECT_EQ(square->faces.size(), 2u);
  expect_sound(*square, 2);
  EXPECT_FALSE(convex_hull({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}}));
  EXPECT_FALSE(convex_hull({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}));
  EXPECT_FALSE(convex_hull({{0, 0, 0}, {0, 0, 1}}));
  EXPECT_FALSE(convex_hull({{0, 0, 0}, {0, 0, 1}, {0, std::nan(""), 0}}));
  const Result<Polytope> plate = convex_hull({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.3, 0.3, 1e-9}});
  ASSERT_TRUE(plate) << plate.error().message();
  EXPECT_EQ(plate->faces.size(), 5u);
  expect_sound(*plate, 2);
}

TEST(DirectionTable, StaysBelowOneKilobyte) { EXPECT_LT(sizeof(Polytope::direction_table), 1024u); }

}  // namespace
}  // namespace tactum::hull_test
