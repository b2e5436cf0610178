#include "tactum/geometry/true_surface.h"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <utility>
#include <vector>

#include "support/real_data.h"
#include "support/sample_meshes.h"
#include "support/sample_solids.h"
#include "tactum/base/random.h"
#include "tactum/geometry/coplanar_groups.h"
#include "tactum/geometry/mesh_report.h"
#include "tactum/mesh/make_part.h"
#include "tactum/mesh/mesh_import.h"
#include "tactum/parts/gear.h"
#include "tactum/parts/generated_parts.h"

namespace tactum::true_surface_test {
namespace {

std::vector<Vec3> box_corners(const Vec3& low, const Vec3& high) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i)
    corners.emplace_back(i & 1 ? high.x() : low.x(), i & 2 ? high.y() : low.y(), i & 4 ? high.z() : low.z());
  return corners;
}

Part part_of(const std::vector<std::vector<Vec3>>& clouds) {
  Result<Part> part = part_from_clouds(clouds);
  EXPECT_TRUE(part);
  return std::move(*part);
}

/// The group of the face of a piece that looks along `normal`.
int group_along(const Part& part, int piece, const Vec3& normal) {
  const Polytope& P = part.pieces[piece];
  for (int f = 0; f < P.counts[2]; ++f)
    if (P.faces[f].normal.dot(normal) > 0.999) return part.true_surface.group_of(piece, 2, f);
  return -2;
}

int true_groups(const Part& part) {
  std::set<int> groups;
  const TrueSurface& surface = part.true_surface;
  for (std::size_t i = 0; i < part.pieces.size(); ++i) {
    const Polytope& P = part.pieces[i];
    for (int f = 0; f < P.counts[2]; ++f) groups.insert(surface.group_of(static_cast<int>(i), 2, f));
  }
  groups.erase(-1);
  return static_cast<int>(groups.size());
}

/// The lists of members agree with the groups of the features.
void expect_listed(const Part& part) {
  const TrueSurface& surface = part.true_surface;
  std::map<int, std::vector<std::pair<int, int>>> groups;
  for (std::size_t i = 0; i < part.pieces.size(); ++i)
    for (int kind : {1, 2})
      for (int index = 0; index < part.pieces[i].counts[std::size_t(kind)]; ++index)
        if (const int group = surface.group_of(int(i), kind, index); group >= 0)
          groups[group].emplace_back(int(i), index);
  std::size_t listed = 0;
  for (const auto& [group, features] : groups) {
    std::vector<std::pair<int, int>> members;
    for (const TrueSurface::Member& m : surface.members_of(group)) members.emplace_back(m.piece, m.index);
    EXPECT_EQ(members, features) << "group " << group;
    listed += members.size();
  }
  EXPECT_EQ(listed, surface.members.size());
}

TEST(TrueSurface, OfTwoBoxesWithACommonWall) {
  const Part part = part_of({box_corners({0, 0, 0}, {1, 1, 1}), box_corners({1, 0, 0}, {3, 1, 1})});
  EXPECT_NEAR(part.true_surface.exposed_area, 14.0, 1e-12);
  EXPECT_EQ(group_along(part, 0, Vec3::UnitX()), -1);
  EXPECT_EQ(group_along(part, 1, -Vec3::UnitX()), -1);
  EXPECT_EQ(group_along(part, 0, Vec3::UnitZ()), group_along(part, 1, Vec3::UnitZ()));
  EXPECT_EQ(true_groups(part), 6);
  expect_listed(part);
}

TEST(TrueSurface, GroupsOfManyPiecesAreListed) {
  std::vector<std::vector<Vec3>> clouds;
  for (int x = 0; x < 5; ++x)
    for (int y = 0; y < 4; ++y) clouds.push_back(box_corners(Vec3(x, y, 0), Vec3(x + 1, y + 1, 1)));
  const Part part = part_of(clouds);
  EXPECT_EQ(true_groups(part), 6);
  expect_listed(part);
}

TEST(TrueSurface, AWallMayBeCoveredInPart) {
  // A small box on a large one.
  const Part part = part_of({box_corners({0, 0, 0}, {4, 4, 1}), box_corners({1, 1, 1}, {2, 2, 2})});
  EXPECT_NEAR(part.true_surface.exposed_area, 16 * 2 + 16 + 4, 1e-12);
  EXPECT_GE(group_along(part, 0, Vec3::UnitZ()), 0);
  EXPECT_EQ(group_along(part, 1, -Vec3::UnitZ()), -1);
  EXPECT_NE(group_along(part, 0, Vec3::UnitZ()), group_along(part, 1, Vec3::UnitZ()));
  EXPECT_EQ(true_groups(part), 11);
}

TEST(TrueSurface, PiecesApartAreAlone) {
  EXPECT_TRUE(part_of({box_corners({0, 0, 0}, {1, 1, 1}), box_corners({2, 0, 0}, {3, 1, 1})})
                  .true_surface.single_piece());
  EXPECT_TRUE(part_of({box_corners({0, 0, 0}, {1, 1, 1})}).true_surface.single_piece());
}

TEST(TrueSurface, OfADecompositionIsTheSurfaceGiven) {
  int tried = 0;
  for (std::uint64_t seed = 1; tried < 30; ++seed) {
    Random random(seed);
    testing::GridSolid solid({0, 1, 2.5, 3, 4.5}, {0, 1.5, 2, 3, 4}, {0, 1, 2, 3.25, 4});
    std::fill(solid.filled.begin(), solid.filled.end(), true);
    for (int i = 0; i < 7; ++i) solid.filled[static_cast<std::size_t>(random.index(64))] = false;
    if (!solid.manifold()) continue;
    ++tried;
    SCOPED_TRACE("seed " + std::to_string(seed));
    const TriangleMesh mesh = testing::transformed(
        solid.mesh(), Quat(1, random.unit(), random.unit(), 0).normalized().toRotationMatrix(),
        Vec3(1, 2, 3));
    const Result<Part> part = part_from_mesh(mesh, {.pieces = PieceSource::kSolid});
    ASSERT_TRUE(part);
    EXPECT_NEAR(part->true_surface.exposed_area, report_mesh(mesh).area, 1e-9 * report_mesh(mesh).area);
    // Walls that the mesh has as one are one, however they were cut. A face that pieces cover in the middle
    // may make one of two.
    const std::vector<int> groups = coplanar_groups(mesh);
    EXPECT_LE(true_groups(*part), 1 + *std::max_element(groups.begin(), groups.end()));
  }
}

TEST(TrueSurface, OfGearsAndHoles) {
  const Gear gear;
  const Result<std::vector<Polytope>> pieces = gear_pieces(gear);
  ASSERT_TRUE(pieces);
  std::vector<std::vector<Vec3>> clouds;
  for (const Polytope& piece : *pieces) clouds.push_back(piece.vertices);
  const Part part = part_of(clouds);
  // Feet of the teeth and their places on the hub are hidden; each end of the gear is one wall.
  const int hub = static_cast<int>(pieces->size()) - 1;
  for (int tooth = 0; tooth < hub; ++tooth) {
    EXPECT_EQ(group_along(part, tooth, Vec3::UnitZ()), group_along(part, hub, Vec3::UnitZ()));
    EXPECT_EQ(group_along(part, tooth, -Vec3::UnitZ()), group_along(part, hub, -Vec3::UnitZ()));
  }
  int hidden = 0;
  for (std::size_t i = 0; i < part.pieces.size(); ++i) {
    const Polytope& P = part.pieces[i];
    for (int f = 0; f < P.counts[2]; ++f) hidden += part.true_surface.group_of(static_cast<int>(i), 2, f) < 0;
  }
  EXPECT_EQ(hidden, 2 * gear.teeth);
}

TEST(TrueSurface, OfRealParts) {
  TACTUM_NEEDS_REAL_DATA();
  for (const char* name :
       {"cube-notch.obj", "cup.obj", "regulator_collision.stl", "sensor_base.stl", "sensor_peg.stl"}) {
    SCOPED_TRACE(name);
    const Result<ImportedMesh> imported = import_mesh(testing::find_real(name).string());
    ASSERT_TRUE(imported);
    const Result<Part> part = part_from_mesh(imported->mesh, {.pieces = PieceSource::kSolid});
    ASSERT_TRUE(part) << part.error().message();
    const double area = report_mesh(imported->mesh).area;
    // Walls that are flat to single precision only are not found covered to the last sliver.
    EXPECT_NEAR(part->true_surface.exposed_area, area, 0.02 * area);
  }
}

}  // namespace
}  // namespace tactum::true_surface_test
