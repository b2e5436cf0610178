#include "tactum/repair/inner_walls.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "support/sample_meshes.h"
#include "support/voxels.h"
#include "tactum/geometry/mass_properties.h"
#include "tactum/geometry/mesh_report.h"
#include "tactum/math/screw.h"
#include "tactum/repair/mesh_repair.h"

namespace tactum {
namespace inner_walls_test {
namespace {

using testing::random_voxels;
using testing::Voxels;

/// One square, cut along a diagonal, with corners of its own.
void add_square(TriangleMesh& mesh, const Vec3& corner, const Vec3& u, const Vec3& v, bool turned) {
  const int base = static_cast<int>(mesh.vertices.size());
  for (const Vec3& p : {corner, Vec3(corner + u), Vec3(corner + u + v), Vec3(corner + v)})
    mesh.vertices.push_back(p);
  for (Triangle t : {Triangle{base, base + 1, base + 2}, Triangle{base, base + 2, base + 3}}) {
    if (turned) std::swap(t[1], t[2]);
    mesh.triangles.push_back(t);
  }
}

/// Every face of a solid cell once, also that between two solid ones; `turned_share` of the faces look the
/// wrong way, and the order is any.
TriangleMesh faces_of(const Voxels& voxels, Random& random, double turned_share) {
  TriangleMesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 u = Vec3::Unit((axis + 1) % 3), v = Vec3::Unit((axis + 2) % 3);
    for (int x = 0; x <= testing::kCells; ++x)
      for (int y = 0; y <= testing::kCells; ++y)
        for (int z = 0; z <= testing::kCells; ++z) {
          const bool above = voxels.at(x, y, z);
          const bool below = voxels.at(x - (axis == 0), y - (axis == 1), z - (axis == 2));
          if (!above && !below) continue;
          add_square(mesh, Vec3(x, y, z), u, v, above != (random.unit() < turned_share));
        }
  }
  for (std::size_t i = mesh.triangles.size(); i > 1; --i)
    std::swap(mesh.triangles[i - 1], mesh.triangles[std::size_t(random.unit() * double(i))]);
  return mesh;
}

/// A row of cells with a wall between each and the next.
Voxels row(int cells) {
  Voxels voxels;
  for (int x = 0; x < cells; ++x) voxels.solid[std::size_t(x * testing::kCells * testing::kCells)] = true;
  return voxels;
}

RepairedMesh repaired_in(const TriangleMesh& mesh, const Mat3& R, double cell) {
  return repair_mesh(testing::transformed(mesh, R * cell, Vec3(0.1, 0.2, -0.3)));
}

TEST(InnerWalls, ASolidWhoseCellsShareWallsHasItsOwnVolumeAreaAndCentre) {
  int with_walls = 0;
  for (std::uint64_t seed = 1; seed <= 80; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    Voxels voxels = random_voxels(random);
    voxels.solid[13] = true;  // the middle one: an empty cell that others enclose could be a room as well
    const double cell = std::pow(10.0, random.uniform(-4.0, 1.0));
    const Mat3 R = seed % 2 == 0 ? Mat3(Mat3::Identity()) : exp_rotation(Vec3(0.3, -0.7, 1.1));
    const TriangleMesh mesh = faces_of(voxels, random, seed % 3 == 0 ? 0.0 : 0.4);
    const RepairedMesh repaired = repaired_in(mesh, R, cell);
    const MeshReport report = report_mesh(repaired.mesh);
    EXPECT_TRUE(report.balanced);
    EXPECT_NEAR(report.volume, voxels.count() * cell * cell * cell, 1e-9 * cell * cell * cell);
    EXPECT_NEAR(report.area, voxels.exposed_faces() * cell * cell, 1e-9 * cell * cell);
    const Result<MassProperties> mass = mass_properties(repaired.mesh, 1000.0);
    ASSERT_TRUE(mass) << mass.error().message();
    Vec3 center = Vec3::Zero();
    voxels.for_each([&](int x, int y, int z) { center += Vec3(x + 0.5, y + 0.5, z + 0.5) / voxels.count(); });
    EXPECT_LT((mass->center - (R * center * cell + Vec3(0.1, 0.2, -0.3))).norm(), 1e-9 * cell);
    const std::size_t walls = mesh.triangles.size() - 2 * std::size_t(voxels.exposed_faces());
    EXPECT_EQ(repaired.walls.size(), walls);
    with_walls += walls > 0;
  }
  EXPECT_GT(with_walls, 70);
}

TEST(InnerWalls, AWallWithAWindowAndASheetInsideGoToo) {
  Random random(1);
  TriangleMesh mesh = faces_of(row(1), random, 0.0);             // a box of one room
  add_square(mesh, {0, 0, 0}, {0.5, 0.5, 0}, {0, 0, 1}, false);  // hangs from an edge into the room
  const RepairedMesh repaired = repaired_in(mesh, Mat3::Identity(), 1.0);
  EXPECT_EQ(repaired.walls.size(), 2u);
  const MeshReport report = report_mesh(repaired.mesh);
  EXPECT_TRUE(report.closed);
  EXPECT_NEAR(report.volume, 1.0, 1e-12);
}

TEST(InnerWalls, ASheetThatStandsOffASolidLeavesTheSolidClosed) {
  for (const int cells : {1, 2, 3}) {
    SCOPED_TRACE(cells);
    Random random(2);
    TriangleMesh mesh = faces_of(row(cells), random, 0.4);
    add_square(mesh, {0, 0, 1}, {0, 1, 0}, {-1, 0, 1}, false);  // from an upper edge outward
    add_square(mesh, {-1, 0, 2}, {0, 1, 0}, {0, 0, 1}, true);   // and on from there
    add_square(mesh, {-1, 0, 2}, {0, 1, 0}, {-1, 0, 0}, true);
    const RepairedMesh repaired = repaired_in(mesh, exp_rotation(Vec3(0.2, 0.1, 0.4)), 0.01);
    double volume = 0.0;
    int open = 0;
    for (const MeshComponent& component : repaired.components) {
      volume += component.volume;
      open += component.closed ? 0 : component.triangles;
    }
    EXPECT_NEAR(volume, 1e-6 * cells, 1e-15);
    EXPECT_EQ(open, 6);
    EXPECT_EQ(repaired.walls.size(), 2u * std::size_t(cells - 1));
  }
}

TEST(InnerWalls, RoomsThatAreOpenHaveNoWalls) {
  Random random(3);
  TriangleMesh mesh = faces_of(row(3), random, 0.0);
  std::erase_if(mesh.triangles, [&](const Triangle& t) {  // no lids
    return std::all_of(t.begin(), t.end(), [&](int v) { return mesh.vertices[v].z() > 0.5; });
  });
  EXPECT_TRUE(repaired_in(mesh, Mat3::Identity(), 1.0).walls.empty());
  EXPECT_TRUE(find_inner_walls(testing::icosphere(2)).empty());
}

}  // namespace
}  // namespace inner_walls_test
}  // namespace tactum
