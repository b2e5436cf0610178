#include "tactum/repair/repeated_triangles.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/sample_meshes.h"
#include "support/voxels.h"
#include "tactum/base/random.h"
#include "tactum/geometry/mass_properties.h"
#include "tactum/geometry/mesh_report.h"
#include "tactum/math/screw.h"
#include "tactum/repair/mesh_repair.h"

namespace tactum {
namespace repeated_triangles_test {
namespace {

using testing::random_voxels;
using testing::Voxels;

/// Each solid cell as a closed box of its own. Both boxes at a wall cut it along the same diagonal; `turned`
/// boxes face inward.
TriangleMesh mesh_of(const Voxels& voxels, Random& random, double turned_share) {
  TriangleMesh mesh;
  voxels.for_each([&](int x, int y, int z) {
    const bool turned = random.unit() < turned_share;
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 2; ++side) {
        const Vec3 corner = Vec3(x, y, z) + side * Vec3::Unit(axis);
        const Vec3 u = Vec3::Unit((axis + 1) % 3), v = Vec3::Unit((axis + 2) % 3);
        const int base = static_cast<int>(mesh.vertices.size());
        for (const Vec3& p : {corner, Vec3(corner + u), Vec3(corner + u + v), Vec3(corner + v)})
          mesh.vertices.push_back(p);
        const bool outward = (side == 1) != turned;
        for (Triangle t : {Triangle{base, base + 1, base + 2}, Triangle{base, base + 2, base + 3}}) {
          if (!outward) std::swap(t[1], t[2]);
          mesh.triangles.push_back(t);
        }
      }
  });
  for (std::size_t i = mesh.triangles.size(); i > 1; --i)
    std::swap(mesh.triangles[i - 1], mesh.triangles[std::size_t(random.unit() * double(i))]);
  return mesh;
}

TEST(RepeatedTriangles, SolidsThatShareFacesAreTheirUnionHoweverEachIsWound) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const Voxels voxels = random_voxels(random);
    const double cell = std::pow(10.0, random.uniform(-4.0, 1.0));
    const Mat3 R = seed % 2 == 0 ? Mat3(Mat3::Identity()) : exp_rotation(Vec3(0.3, -0.7, 1.1));
    const TriangleMesh mesh = testing::transformed(mesh_of(voxels, random, seed % 3 == 0 ? 0.0 : 0.4),
                                                   R * cell, Vec3(0.1, 0.2, -0.3));
    const RepairedMesh repaired = repair_mesh(mesh);
    const MeshReport report = report_mesh(repaired.mesh);
    EXPECT_TRUE(report.balanced);
    EXPECT_NEAR(report.volume, voxels.count() * cell * cell * cell, 1e-9 * cell * cell * cell);
    EXPECT_NEAR(report.area, voxels.exposed_faces() * cell * cell, 1e-9 * cell * cell);
    const Result<MassProperties> mass = mass_properties(repaired.mesh, 1000.0);
    ASSERT_TRUE(mass) << mass.error().message();
    Vec3 center = Vec3::Zero();
    voxels.for_each([&](int x, int y, int z) { center += Vec3(x + 0.5, y + 0.5, z + 0.5) / voxels.count(); });
    EXPECT_LT((mass->center - (R * center * cell + Vec3(0.1, 0.2, -0.3))).norm(), 1e-9 * cell);
  }
}

TEST(RepeatedTriangles, WallsCutAlongOtherDiagonalsKeepTheVolume) {
  // Two boxes on each other, the common face cut differently: the walls stay, and the edges around them have
  // four triangles.
  TriangleMesh mesh = testing::box_mesh({1, 1, 1});
  TriangleMesh upper = testing::transformed(testing::box_mesh({1, 1, 1}), Mat3::Identity(), {0, 0, 2});
  for (std::size_t i = 0; i + 1 < upper.triangles.size(); ++i) {
    Triangle& a = upper.triangles[i];
    Triangle& b = upper.triangles[i + 1];
    const auto low = [&](const Triangle& t) {
      return std::all_of(t.begin(), t.end(), [&](int v) { return upper.vertices[v].z() < 1.5; });
    };
    if (!low(a) || !low(b)) continue;
    const auto lonely = [](const Triangle& one, const Triangle& other) {
      return *std::find_if(one.begin(), one.end(),
                           [&](int v) { return std::find(other.begin(), other.end(), v) == other.end(); });
    };
    const int p = lonely(a, b), q = lonely(b, a);
    while (a[0] != p) std::rotate(a.begin(), a.begin() + 1, a.end());
    const int first = a[1], second = a[2];
    a = {p, first, q};
    b = {p, q, second};
    break;
  }
  const int base = static_cast<int>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), upper.vertices.begin(), upper.vertices.end());
  for (const Triangle& t : upper.triangles) mesh.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
  const RepairedMesh repaired = repair_mesh(mesh);
  EXPECT_EQ(repaired.components.size(), 1u);
  EXPECT_TRUE(repaired.components[0].closed);
  const Result<MassProperties> mass = mass_properties(repaired.mesh, 1.0);
  ASSERT_TRUE(mass) << mass.error().message();
  EXPECT_NEAR(mass->volume, 16.0, 1e-12);
  EXPECT_LT((mass->center - Vec3(0, 0, 1)).norm(), 1e-12);
}

TEST(RepeatedTriangles, CopiesGoWhicheverWayTheyFace) {
  const TriangleMesh ball = testing::icosphere(2);
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    TriangleMesh mesh = ball;
    for (const Triangle& t : ball.triangles)
      for (double chance = random.unit(); chance > 0.5; chance -= 0.25)
        mesh.triangles.push_back(random.unit() < 0.5 ? t : Triangle{t[1], t[0], t[2]});
    const std::size_t more = mesh.triangles.size() - ball.triangles.size();
    EXPECT_EQ(find_repeated_triangles(mesh).copies.size(), more);
    const RepairedMesh repaired = repair_mesh(mesh);
    EXPECT_EQ(repaired.mesh.triangles.size(), ball.triangles.size());
    EXPECT_NEAR(report_mesh(repaired.mesh).volume, report_mesh(ball).volume, 1e-12);
  }
}

TriangleMesh with_back(TriangleMesh mesh) {
  const std::vector<Triangle> front = mesh.triangles;
  for (const Triangle& t : front) mesh.triangles.push_back({t[0], t[2], t[1]});
  return mesh;
}

TEST(RepeatedTriangles, SheetsOfTwoSidesKeepOneAndStayOpen) {
  for (const int cells : {1, 2, 5}) {
    const RepeatedTriangles found = find_repeated_triangles(with_back(testing::sheet(cells, 0.5)));
    EXPECT_TRUE(found.copies.empty() && found.walls.empty());
    EXPECT_EQ(found.sheets.size(), std::size_t(2 * cells * cells));
    const RepairedMesh repaired = repair_mesh(with_back(testing::sheet(cells, 0.5)));
    ASSERT_EQ(repaired.components.size(), 1u);
    EXPECT_FALSE(repaired.components[0].closed);
    EXPECT_NEAR(repaired.components[0].area, 1.0, 1e-12);
  }
}

TEST(RepeatedTriangles, AFinInTheOpenStaysAndAWallInsideGoes) {
  // A sheet of two sides that ends at an edge of a box, outside of it and across its inside.
  for (const bool inside : {false, true}) {
    TriangleMesh mesh = testing::box_mesh({1, 1, 1});
    const auto corner = [&](const Vec3& place) {
      for (int v = 0; v < static_cast<int>(mesh.vertices.size()); ++v)
        if (mesh.vertices[v] == place) return v;
      mesh.vertices.push_back(place);
      return static_cast<int>(mesh.vertices.size()) - 1;
    };
    const double far = inside ? 1.0 : -3.0;
    const int a = corner({-1, -1, -1}), b = corner({-1, -1, 1}), c = corner({far, far, 1}),
              d = corner({far, far, -1});
    for (const Triangle& t : {Triangle{a, b, c}, Triangle{a, c, d}}) {
      mesh.triangles.push_back(t);
      mesh.triangles.push_back({t[1], t[0], t[2]});
    }
    const RepeatedTriangles found = find_repeated_triangles(mesh);
    EXPECT_EQ(found.walls.size(), inside ? 4u : 0u);
    EXPECT_EQ(found.sheets.size(), inside ? 0u : 2u);
    EXPECT_TRUE(found.copies.empty());
  }
}

}  // namespace
}  // namespace repeated_triangles_test
}  // namespace tactum
