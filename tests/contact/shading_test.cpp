#include "tactum/contact/shading.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tactum/geometry/hull.h"
#include "tactum/geometry/polygon_clip.h"
#include "tactum/geometry/primitives.h"
#include "tactum/mesh/make_part.h"

namespace tactum {
namespace {

Part part_of(const Polytope& polytope) {
  Result<Part> part = part_from_clouds({polytope.vertices});
  EXPECT_TRUE(part);
  return std::move(*part);
}

int face_towards(const Polytope& P, const Vec3& direction) {
  int best = 0;
  for (std::size_t f = 0; f < P.faces.size(); ++f)
    if (P.faces[f].normal.dot(direction) > P.faces[std::size_t(best)].normal.dot(direction)) best = int(f);
  return best;
}

TEST(Shading, AFacetedCylinderHasTheNormalsOfARoundOne) {
  const int sides = 32;
  const Part part = part_of(make_prism(sides, 0.01, 0.03));
  const ShadingNormals shading(part, 0.6);
  const Polytope& P = part.pieces[0];
  double worst = 0.0;
  double worst_flat = 0.0;
  for (int k = 0; k < 2000; ++k) {
    const double angle = 2 * kPi * k / 2000.0;
    const double in_facet = std::fmod(angle, 2 * kPi / sides) - kPi / sides;
    const Vec3 radial(std::cos(angle), std::sin(angle), 0);
    const double radius = 0.01 * std::cos(kPi / sides) / std::cos(in_facet);  // on the flat side
    const int f = face_towards(P, radial);
    const Vec3 face = P.faces[std::size_t(f)].normal;
    const Vec3 shaded =
        face + shading.deviation(0, {FeatureKind::kFace, f}, radius * radial + Vec3(0, 0, 0.004));
    worst = std::max(worst, (shaded - radial).norm());
    worst_flat = std::max(worst_flat, (face - radial).norm());
  }
  EXPECT_LT(worst, 1e-3);  // of a normal that turns by 0.2 rad from facet to facet
  EXPECT_GT(worst_flat, 0.09);
}

TEST(Shading, SharpEdgesAndOtherFeaturesAreLeftAlone) {
  const Part part = part_of(make_box({0.01, 0.02, 0.03}));
  const ShadingNormals shading(part, 0.6);
  for (int f = 0; f < 6; ++f)
    EXPECT_EQ(shading.deviation(0, {FeatureKind::kFace, f}, Vec3(0.001, 0.002, 0.003)).norm(), 0.0);
  const Part round = part_of(make_prism(32, 0.01, 0.03));
  const ShadingNormals round_shading(round, 0.6);
  EXPECT_EQ(round_shading.deviation(0, {FeatureKind::kEdge, 3}, Vec3::Zero()).norm(), 0.0);
}

/// Around faces that pieces cover from each other there are no faces whose normals could be meant.
TEST(Shading, WallsBetweenPiecesBendNothing) {
  std::vector<std::vector<Vec3>> clouds(2, make_box({0.01, 0.02, 0.03}).vertices);
  for (Vec3& p : clouds[1]) p.x() += 0.02;
  Result<Part> part = part_from_clouds(clouds);
  ASSERT_TRUE(part);
  ASSERT_FALSE(part->true_surface.single_piece());
  const ShadingNormals shading(*part, 0.6);
  EXPECT_FALSE(shading.bends());
  for (std::size_t p = 0; p < part->pieces.size(); ++p) {
    for (int f = 0; f < part->pieces[p].counts[2]; ++f)
      EXPECT_EQ(shading.deviation(int(p), {FeatureKind::kFace, f}, Vec3::Zero()).norm(), 0.0)
          << p << ' ' << f;
  }
}

Vec3 shaded_at(const ShadingNormals& shading, const Polytope& P, int face, const Vec3& p) {
  return P.faces[std::size_t(face)].normal + shading.deviation(0, {FeatureKind::kFace, face}, p);
}

/// Inside every face the normal is that of its corners, weighed by Wachspress' quotients of areas.
void expect_weighed(const ShadingNormals& shading, const Polytope& P) {
  for (int f = 0; f < P.counts[2]; ++f) {
    const std::vector<Vec3> corners = face_corners(P, f);
    const std::size_t n = corners.size();
    const Vec3& normal = P.faces[std::size_t(f)].normal;
    const auto area = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
      return normal.dot((b - a).cross(c - a));
    };
    Vec3 p = Vec3::Zero();  // inside, not in the middle
    for (std::size_t i = 0; i < n; ++i) p += corners[i] * (double(i + 1) / (0.5 * double(n * (n + 1))));
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3& last = corners[(i + n - 1) % n];
      const Vec3& next = corners[(i + 1) % n];
      sum += area(last, corners[i], next) / (area(last, corners[i], p) * area(corners[i], next, p)) *
             shaded_at(shading, P, f, corners[i]);
    }
    ASSERT_LT((sum.normalized() - shaded_at(shading, P, f, p)).norm(), 1e-9) << f;
  }
}

/// From face to face the normal is the same on the edge between them, and nearly that of the ball.
void expect_continuous(const Polytope& ball, double nearly) {
  const Part part = part_of(ball);
  const ShadingNormals shading(part, 0.6);
  const Polytope& P = part.pieces[0];
  for (const Polytope::Edge& edge : P.edges) {
    for (double t : {0.0, 0.3, 0.5, 1.0}) {
      const Vec3 p = (1 - t) * P.vertices[std::size_t(edge.tail)] + t * P.vertices[std::size_t(edge.head)];
      const Vec3 left = shaded_at(shading, P, edge.left, p);
      const Vec3 right = shaded_at(shading, P, edge.right, p);
      ASSERT_LT((left - right).norm(), 1e-9);
      ASSERT_LT((left - p.normalized()).norm(), nearly);
    }
  }
  expect_weighed(shading, P);
}

/// Facets of a cylinder are parallelograms, with one normal along each straight side; those of a cone are
/// not.
TEST(Shading, RuledFacesAreWeighedAsAnyOther) {
  for (const double top : {0.01, 0.006}) {
    constexpr int kSides = 24;
    std::vector<Vec3> cloud;
    for (int k = 0; k < kSides; ++k) {
      const double east = 2 * kPi * k / kSides;
      cloud.emplace_back(0.01 * std::cos(east), 0.01 * std::sin(east), 0.0);
      cloud.emplace_back(top * std::cos(east), top * std::sin(east), 0.03);
    }
    const Part part = part_of(*convex_hull(cloud));
    const ShadingNormals shading(part, 0.6);
    ASSERT_TRUE(shading.bends());
    expect_weighed(shading, part.pieces[0]);
  }
}

TEST(Shading, ContinuousAcrossTheEdgesOfTriangles) { expect_continuous(make_icosphere(2, 0.02), 0.02); }

/// Between parallels and meridians, where all four corners have other normals.
TEST(Shading, ContinuousAcrossTheEdgesOfQuadrilaterals) {
  constexpr int kParallels = 13, kMeridians = 24;
  std::vector<Vec3> cloud = {{0, 0, 0.02}, {0, 0, -0.02}};
  for (int i = 1; i < kParallels; ++i)
    for (int k = 0; k < kMeridians; ++k) {
      const double north = kPi * i / kParallels;
      const double east = 2 * kPi * k / kMeridians;
      cloud.push_back(
          0.02 * Vec3(std::sin(north) * std::cos(east), std::sin(north) * std::sin(east), std::cos(north)));
    }
  const Result<Polytope> globe = convex_hull(cloud);
  ASSERT_TRUE(globe);
  EXPECT_EQ(std::count_if(globe->faces.begin(), globe->faces.end(),
                          [](const Polytope::Face& f) { return f.count == 4; }),
            (kParallels - 2) * kMeridians);
  expect_continuous(*globe, 0.03);
}

}  // namespace
}  // namespace tactum
