#include "tactum/geometry/mass_properties.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <utility>

#include "support/sample_meshes.h"
#include "support/surface_shapes.h"
#include "tactum/math/screw.h"

namespace tactum::mass_properties_test {
namespace {

using testing::box_mesh;
using testing::icosphere;
using testing::prism;
using testing::transformed;

TEST(MassProperties, BoxAnywhereTurnedAnyhow) {
  const Vec3 half(0.01, 0.02, 0.03);
  const Mat3 R = exp_rotation(Vec3(0.3, -1.1, 0.7));
  const Vec3 p(0.5, -0.2, 3.0);
  const Result<MassProperties> mass = mass_properties(transformed(box_mesh(half), R, p), 2700.0);
  ASSERT_TRUE(mass);
  const double kg = 2700.0 * 8.0 * half.prod();
  EXPECT_NEAR(mass->mass, kg, 1e-12 * kg);
  EXPECT_LT((mass->center - p).norm(), 1e-13);
  const Vec3 sq = half.cwiseProduct(half);
  const Mat3 expected = R * (kg / 3.0 * (Vec3::Constant(sq.sum()) - sq)).asDiagonal() * R.transpose();
  EXPECT_LT((mass->inertia - expected).norm(), 1e-11 * expected.norm());
}

TEST(MassProperties, CornerTetrahedron) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  const Result<MassProperties> mass = mass_properties(mesh, 6.0);
  ASSERT_TRUE(mass);
  EXPECT_NEAR(mass->mass, 1.0, 1e-15);
  EXPECT_LT((mass->center - Vec3::Constant(0.25)).norm(), 1e-15);
  // About the corner: integral of x^2 is 1/10, of xy 1/20 (mass one); about the centre less 1/16 each.
  EXPECT_NEAR(mass->inertia(0, 0), 2.0 * (0.1 - 0.0625), 1e-15);
  EXPECT_NEAR(mass->inertia(0, 1), -(0.05 - 0.0625), 1e-15);
}

TEST(MassProperties, SphereConvergesWithTheSquareOfTheMesh) {
  double last = 1.0;
  for (int level = 2; level <= 5; ++level) {
    const Result<MassProperties> mass = mass_properties(icosphere(level), 1.0);
    ASSERT_TRUE(mass);
    const double error = 1.0 - mass->volume / (4.0 / 3.0 * kPi);
    EXPECT_GT(error, 0.0);
    EXPECT_TRUE(level == 2 || std::abs(last / error - 4.0) < 0.35) << level;
    EXPECT_LT((mass->inertia - mass->inertia(0, 0) * Mat3::Identity()).norm(), 1e-12);
    last = error;
  }
  EXPECT_LT(last, 2e-3);
}

TEST(MassProperties, PrismOverARegularPolygon) {
  const int n = 7;
  const double r = 0.4;
  const double half = 0.9;
  const Result<MassProperties> mass = mass_properties(prism(n, r, half), 5.0);
  ASSERT_TRUE(mass);
  const double area = 0.5 * n * r * r * std::sin(2.0 * kPi / n);
  EXPECT_NEAR(mass->volume, 2.0 * half * area, 1e-13);
  const double about_axis = mass->mass * r * r / 6.0 * (2.0 + std::cos(2.0 * kPi / n));
  EXPECT_NEAR(mass->inertia(2, 2), about_axis, 1e-12);
  EXPECT_NEAR(mass->inertia(0, 0), about_axis / 2.0 + mass->mass * half * half / 3.0, 1e-12);
}

TEST(MassProperties, OpenTurnedAndFlatSurfacesAreTold) {
  TriangleMesh open = box_mesh({1, 1, 1});
  open.triangles.pop_back();
  const Result<MassProperties> refused = mass_properties(open, 1.0);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message().find("3 boundary"), std::string::npos) << refused.error().message();
  const MassProperties hull = mass_properties_or_hull(open, 1.0);
  EXPECT_NEAR(hull.volume, 8.0, 1e-12);
  EXPECT_NE(hull.approximation.find("convex hull"), std::string::npos);

  TriangleMesh inward = box_mesh({1, 1, 1});
  for (Triangle& t : inward.triangles) std::swap(t[0], t[1]);
  EXPECT_FALSE(mass_properties(inward, 1.0));
  EXPECT_NEAR(mass_properties_or_hull(inward, 1.0).volume, 8.0, 1e-12);

  TriangleMesh flat;
  flat.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  flat.triangles = {{0, 1, 2}};
  EXPECT_NE(mass_properties_or_hull(flat, 1.0).approximation.find("box"), std::string::npos);
  EXPECT_GT(mass_properties_or_hull(flat, 1.0).mass, 0.0);
  EXPECT_TRUE(mass_properties_or_hull(box_mesh({1, 1, 1}), 1.0).approximation.empty());
}

/// Closed surfaces whose parts cancel: their moments are those of no solid, so that the hull's are taken.
TEST(MassProperties, ASurfaceWhosePartsCancelHasThoseOfItsHull) {
  for (const double size : {1e-3, 1.0, 100.0}) {
    for (const double less : {1.0 - 1e-15, 1.0 - 1e-13, 0.999, 0.9}) {
      SCOPED_TRACE(fmt::format("size {} less {}", size, less));
      TriangleMesh mesh = box_mesh(Vec3(1, 2, 3) * size);
      TriangleMesh turned = box_mesh(Vec3(1, 2, 3) * size * less);  // beside it, inside out
      for (Triangle& t : turned.triangles) std::swap(t[0], t[1]);
      for (Vec3& vertex : turned.vertices) vertex.x() += 4.0 * size;
      mesh = testing::joined(std::move(mesh), turned);
      EXPECT_FALSE(mass_properties(mesh, 1.0));
      const MassProperties mass = mass_properties_or_hull(mesh, 1.0);
      EXPECT_NE(mass.approximation.find("convex hull"), std::string::npos) << mass.approximation;
      EXPECT_LT(std::abs(mass.center.x() - 2.0 * size), 2.0 * size);
      EXPECT_GT(mass.inertia.eigenvalues().real().minCoeff(), 0.0);
    }
  }
}

TEST(MassProperties, SheetsBesideASolidHaveNoMass) {
  for (const double size : {1e-3, 1.0, 100.0}) {
    for (const bool inward : {false, true}) {
      SCOPED_TRACE(size);
      TriangleMesh mesh = box_mesh(Vec3(1, 2, 3) * size);
      if (inward)
        for (Triangle& t : mesh.triangles) std::swap(t[0], t[1]);
      const int base = static_cast<int>(mesh.vertices.size());
      // A fin of two triangles from an edge of the box, and a sheet that touches nothing.
      const Triangle on = mesh.triangles[0];
      const Vec3 out = mesh.vertices[on[0]] * 1.5;
      mesh.vertices.push_back(out);
      mesh.vertices.push_back(out * 1.1);
      mesh.triangles.push_back({on[0], on[1], base});
      mesh.triangles.push_back({on[1], base + 1, base});
      for (const Vec3& corner : {Vec3(5, 0, 0), Vec3(6, 0, 0), Vec3(5, 1, 0)})
        mesh.vertices.push_back(corner * size);
      mesh.triangles.push_back({base + 2, base + 3, base + 4});
      const MassProperties mass = mass_properties_or_hull(mesh, 2.0);
      const double volume = 48.0 * size * size * size;
      EXPECT_NEAR(mass.volume, volume, 1e-12 * volume);
      EXPECT_LT(mass.center.norm(), 1e-12 * size);
      EXPECT_NEAR(mass.inertia(0, 0), 2.0 * volume / 3.0 * 13.0 * size * size,
                  1e-12 * volume * size * size * 10);
      EXPECT_NE(mass.approximation.find("Of the 15 triangles 3 bound no solid"), std::string::npos)
          << mass.approximation;
    }
  }
  // A small solid in a large body that is open does not stand for it.
  TriangleMesh mesh = box_mesh({1, 1, 1});
  TriangleMesh bowl = box_mesh({10, 10, 10});
  bowl.triangles.pop_back();
  for (const Triangle& t : bowl.triangles) mesh.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
  mesh.vertices.insert(mesh.vertices.end(), bowl.vertices.begin(), bowl.vertices.end());
  EXPECT_NE(mass_properties_or_hull(mesh, 1.0).approximation.find("convex hull"), std::string::npos);
}

}  // namespace
}  // namespace tactum::mass_properties_test
