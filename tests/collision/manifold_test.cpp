#include "tactum/collision/manifold.h"

#include <gtest/gtest.h>

#include "collision/manifold_contact.h"
#include "tactum/geometry/hull.h"
#include "tactum/math/screw.h"

namespace tactum {
namespace {

using namespace manifold_tests;

TEST(Manifold, FaceOnFaceHasAreaAndMomentsOfTheSharedRectangle) {
  // B beside and below A: shared rectangle 0.03 x 0.04 about (0.005, 0.01).
  const Contact c = contact(box(), box(), above(0.01, 0.02, -0.0201), 0.001);
  expect_kinds(c.patch, Kind::kFace, Kind::kFace, 4);
  EXPECT_NEAR(c.patch.area, 0.03 * 0.04, 1e-15);
  EXPECT_TRUE(centroid(c.patch).isApprox(Vec3(0.005, 0.01, -0.01005), 1e-12));
  EXPECT_NEAR(second_moment(c.patch, Vec3::UnitX(), Vec3::UnitX()), 0.03 * 0.03 / 12, 1e-15);
  EXPECT_NEAR(second_moment(c.patch, Vec3::UnitY(), Vec3::UnitY()), 0.04 * 0.04 / 12, 1e-15);
  EXPECT_NEAR(second_moment(c.patch, Vec3::UnitX(), Vec3::UnitY()), 0.0, 1e-15);
  EXPECT_TRUE(c.patch.normal.isApprox(Vec3::UnitZ()));
  for (const ContactPoint& p : c.patch.points) EXPECT_NEAR(p.distance, 0.0001, 1e-15);
}

TEST(Manifold, FaceOnFaceWhenOverlapping) {
  const Contact c = contact(box(), box(), above(0.01, 0.02, -0.0195), 0.001);
  EXPECT_NEAR(c.closest.distance, -0.0005, 1e-12);
  expect_kinds(c.patch, Kind::kFace, Kind::kFace, 4);
  EXPECT_NEAR(c.patch.area, 0.03 * 0.04, 1e-12);
  for (const ContactPoint& p : c.patch.points) EXPECT_NEAR(p.distance, -0.0005, 1e-12);
}

TEST(Manifold, EdgeOnFaceIsTheClippedInterval) {
  const Mat3 on_edge = exp_rotation(Vec3(0, 0.25 * kPi, 0));  // about y: an edge along y points up
  const double height = std::sqrt(0.02 * 0.02 + 0.01 * 0.01) * std::sin(std::atan2(0.01, 0.02) + 0.25 * kPi);
  const Contact c = contact(box(), box(), above(0, 0.015, -0.01 - height - 0.0002, on_edge), 0.001);
  expect_kinds(c.patch, Kind::kFace, Kind::kEdge, 2);
  EXPECT_NEAR(centroid(c.patch).y(), 0.0075, 1e-12);  // y from -0.015 to 0.03
  EXPECT_NEAR(second_moment(c.patch, Vec3::UnitY(), Vec3::UnitY()), 0.045 * 0.045 / 12, 1e-14);
  for (const ContactPoint& p : c.patch.points) EXPECT_NEAR(p.distance, 0.0002, 1e-12);
}

TEST(Manifold, ParallelEdgesShareAnInterval) {
  const Polytope prism = make_prism(4, 0.02, 0.06);  // corners on x and y: an edge along z at x = 0.02
  const Contact c = contact(prism, prism, above(-0.0403, 0, 0.02), 0.001);
  expect_kinds(c.patch, Kind::kEdge, Kind::kEdge, 2);
  EXPECT_NEAR(centroid(c.patch).z(), 0.01, 1e-12);
  EXPECT_NEAR(second_moment(c.patch, Vec3::UnitZ(), Vec3::UnitZ()), 0.04 * 0.04 / 12, 1e-14);
  for (const ContactPoint& p : c.patch.points) EXPECT_NEAR(p.distance, 0.0003, 1e-12);
}

TEST(Manifold, CrossingEdgesMeetInAPoint) {
  const Polytope prism = make_prism(4, 0.02, 0.06);
  const Mat3 turned = exp_rotation(Vec3(0.5 * kPi, 0, 0));  // the edge now along y
  const Contact c = contact(prism, prism, above(-0.0403, 0.001, 0.002, turned), 0.001);
  expect_kinds(c.patch, Kind::kEdge, Kind::kEdge, 1);
  EXPECT_TRUE(centroid(c.patch).isApprox(Vec3(-0.02015, 0, 0.002), 0.06));
  EXPECT_NEAR(c.patch.points[0].distance, 0.0003, 1e-12);
}

TEST(Manifold, VertexOnFaceEdgeAndVertex) {
  const Polytope tip =
      *convex_hull({{0, 0, 0}, {0.01, 0, -0.03}, {-0.01, 0.01, -0.03}, {-0.01, -0.01, -0.03}});
  const Contact face = contact(box(), tip, above(0.003, 0.004, -0.0101), 0.001);
  expect_kinds(face.patch, Kind::kFace, Kind::kVertex, 1);
  EXPECT_TRUE(face.patch.points[0].p_b.isApprox(Vec3(0.003, 0.004, -0.0101), 1e-12));
  const Polytope prism = make_prism(4, 0.02, 0.06);
  const Mat3 sideways = exp_rotation(Vec3(0, 0.5 * kPi, 0));  // the tip now points along x
  const Contact edge = contact(prism, tip, above(-0.0202, 0, 0.01, sideways), 0.001);
  expect_kinds(edge.patch, Kind::kEdge, Kind::kVertex, 1);
  EXPECT_NEAR(edge.patch.points[0].distance, 0.0002, 1e-12);
  const Mat3 down = exp_rotation(Vec3(kPi, 0, 0));
  const Contact vertex = contact(tip, tip, above(0, 0, 0.0003, down), 0.001);
  expect_kinds(vertex.patch, Kind::kVertex, Kind::kVertex, 1);
  EXPECT_NEAR(vertex.patch.points[0].distance, 0.0003, 1e-12);
}

TEST(Manifold, ManyCorneredFacesFit) {
  const Polytope prism = make_prism(200, 0.02, 0.01);
  const Contact c = contact(prism, prism, above(0.001, 0, -0.0101, exp_rotation(Vec3(0, 0, 0.01))), 0.001);
  expect_kinds(c.patch, Kind::kFace, Kind::kFace, 4);
  const double r = 0.02;
  const double lens = 2 * r * r * std::acos(0.001 / (2 * r)) - 0.0005 * std::sqrt(4 * r * r - 1e-6);
  EXPECT_NEAR(c.patch.area / lens, 1.0, 0.01);
  EXPECT_LT(c.patch.area, lens);  // never more than there is
}

/// A pose that is none leaves the nearest points.
TEST(Manifold, OfAPoseThatIsNotFiniteIsAPoint) {
  const Pose level = above(0.001, 0.002, -0.02);
  PairCache cache;
  const PairDistance closest = closest_features(box(), box(), level, cache);
  Pose broken = level;
  broken.p.x() = std::nan("");
  Manifold patch;
  contact_manifold(box(), box(), broken, closest, 1e-2, patch);
  ASSERT_EQ(patch.points.size(), 1u);
  EXPECT_EQ(patch.points[0].p_a, closest.p_a);
}

}  // namespace
}  // namespace tactum
