#include "tactum/geometry/surface_tree.h"

#include <gtest/gtest.h>

#include <cstring>
#include <set>
#include <vector>

#include "support/effort.h"
#include "support/real_data.h"
#include "support/sample_meshes.h"
#include "support/surface_shapes.h"
#include "tactum/geometry/surface_cones.h"
#include "tactum/geometry/weld.h"
#include "tactum/mesh/mesh_import.h"

namespace tactum::surface_tree_test {
namespace {

std::array<std::set<std::int32_t>, 3> features_of(const SurfaceTree& tree) {
  std::array<std::set<std::int32_t>, 3> found;
  const auto walk = [&](const auto& self, std::int32_t at, SurfaceTree::Kind kind) -> void {
    for (std::int32_t child : tree.nodes()[std::size_t(at)].child) {
      if (child > 0) self(self, child, kind);
      if (child >= 0) continue;
      for (std::int32_t corner : tree.leaves()[std::size_t(~child)]) {
        if (corner < 0) continue;
        EXPECT_TRUE(found[kind].insert(corner).second);
      }
    }
  };
  for (const auto kind : {SurfaceTree::kVertices, SurfaceTree::kEdges, SurfaceTree::kFaces}) {
    if (tree.root(kind) >= 0) walk(walk, tree.root(kind), kind);
  }
  return found;
}

TEST(SurfaceTree, HoldsTheFeaturesThatHaveACone) {
  const auto box = features_of(SurfaceTree(testing::box_mesh({0.01, 0.02, 0.03})));
  EXPECT_EQ(box[SurfaceTree::kVertices].size(), 8u);
  EXPECT_EQ(box[SurfaceTree::kEdges].size(), 12u);  // not the diagonals
  EXPECT_EQ(box[SurfaceTree::kFaces].size(), 12u);

  // Turned inside out nothing but faces is left.
  TriangleMesh room = testing::box_mesh({0.01, 0.02, 0.03});
  for (Triangle& t : room.triangles) std::swap(t[1], t[2]);
  const auto inside = features_of(SurfaceTree(room));
  EXPECT_EQ(inside[SurfaceTree::kVertices].size(), 0u);
  EXPECT_EQ(inside[SurfaceTree::kEdges].size(), 0u);
  EXPECT_EQ(inside[SurfaceTree::kFaces].size(), 12u);

  // A sheet of flat cells keeps its rim.
  Random random(1);
  const SurfaceTree sheet(testing::bumpy_sheet(random, 4, 0.01, 0.0));
  const auto rim = features_of(sheet);
  EXPECT_EQ(rim[SurfaceTree::kVertices].size(), 4u);  // corners: along a straight rim there are none
  EXPECT_EQ(rim[SurfaceTree::kEdges].size(), 16u);
  EXPECT_EQ(sheet.group_of(0), sheet.group_of(31));
}

TEST(SurfaceTree, BoxesHoldWhatIsBelowThem) {
  const SurfaceTree tree(testing::torus(30, 17, 0.02, 0.005));
  const auto check = [&](const auto& self, std::int32_t at, SurfaceTree::Kind kind) -> std::vector<Vec3> {
    const std::size_t points = std::size_t(kind) + 1;
    std::vector<Vec3> all;
    const SurfaceTree::Node& node = tree.nodes()[std::size_t(at)];
    for (std::size_t lane = 0; lane < std::size_t(SurfaceTree::kLanes); ++lane) {
      std::vector<Vec3> below;
      if (node.child[lane] > 0) below = self(self, node.child[lane], kind);
      if (node.child[lane] < 0) {
        for (std::int32_t corner : tree.leaves()[std::size_t(~node.child[lane])]) {
          if (corner < 0) continue;
          for (std::size_t k = 0; k < points; ++k)
            below.push_back(tree.vertex(tree.triangle(corner / 3)[(std::size_t(corner) + k) % 3]));
        }
      }
      const auto at_lane = [&](const SurfaceTree::Lanes3& v) {
        return Vec3(v[0][lane], v[1][lane], v[2][lane]);
      };
      const Vec3 up = at_lane(node.at.up);
      const Vec3 along = at_lane(node.at.along);
      const Vec3 half = at_lane(node.half);
      for (const Vec3& p : below) {
        const Vec3 off = p - tree.center() - at_lane(node.at.center);
        EXPECT_LE(std::abs(along.dot(off)), half[0]);
        EXPECT_LE(std::abs(at_lane(node.at.across).dot(off)), half[1]);
        EXPECT_LE(std::abs(up.dot(off)), half[2]);
      }
      all.insert(all.end(), below.begin(), below.end());
    }
    return all;
  };
  EXPECT_EQ(check(check, tree.root(SurfaceTree::kFaces), SurfaceTree::kFaces).size(), 3 * 2 * 30 * 17u);
  check(check, tree.root(SurfaceTree::kEdges), SurfaceTree::kEdges);
  check(check, tree.root(SurfaceTree::kVertices), SurfaceTree::kVertices);
}

TEST(SurfaceTree, PolarConesAreSquareToTheirEdges) {
  // Of a cube's corner: the octant opposite.
  const std::vector<Vec3> rays = polar_cone({Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()});
  ASSERT_FALSE(rays.empty());
  for (const Vec3& wanted : {Vec3(-1, 0, 0), Vec3(0, -1, 0), Vec3(0, 0, -1)}) {
    double nearest = 1.0;
    for (const Vec3& ray : rays) {
      EXPECT_LE(ray.maxCoeff(), 1e-12);
      nearest = std::min(nearest, (ray - wanted).norm());
    }
    EXPECT_LT(nearest, 1e-12);
  }
  // Edges all around, or along a straight line: none.
  EXPECT_TRUE(polar_cone({Vec3::UnitX(), -Vec3::UnitX(), Vec3::UnitY(), -Vec3::UnitY(), Vec3::UnitZ(),
                          -Vec3::UnitZ()})
                  .empty());
  EXPECT_TRUE(polar_cone({Vec3::UnitX(), -Vec3::UnitX(), Vec3::UnitY()}).empty());
}

TEST(SurfaceTree, TakesAtMost120BytesATriangle) {
  for (const TriangleMesh& mesh : {testing::icosphere(5), testing::torus(100, 60, 0.02, 0.006)}) {
    const SurfaceTree tree(mesh);
    EXPECT_LE(double(tree.memory()), 120.0 * tree.triangle_count());
  }
}

TEST(SurfaceTree, OfRealPartsTakesAtMost120BytesATriangle) {
  TACTUM_NEEDS_REAL_DATA();
  for (const char* name : testing::sampled(
           std::vector{"industreal_gear_small.obj", "factory_bolt_m16_loose.obj", "spot.obj"}, 3)) {
    const Result<ImportedMesh> mesh = import_mesh(testing::find_real(name).string());
    ASSERT_TRUE(mesh) << name;
    WeldOptions options;
    options.drop_zero_area = options.drop_duplicates = true;
    const SurfaceTree tree(weld(mesh->mesh, options).mesh);
    EXPECT_TRUE(tree.sound());
    EXPECT_LE(double(tree.memory()), 120.0 * tree.triangle_count()) << name;
  }
}

TEST(SurfaceTree, IsTheSameAfterItsArraysWereWrittenAndRead) {
  const SurfaceTree tree(testing::torus(20, 10, 0.02, 0.006));
  std::vector<std::vector<char>> file;
  tree.for_each_array([&](const auto& array) {
    std::vector<char> bytes(array.size() * sizeof(array[0]));
    std::memcpy(bytes.data(), array.data(), bytes.size());
    file.push_back(bytes);
  });
  SurfaceTree back;
  back.scalars() = tree.scalars();
  std::size_t next = 0;
  back.for_each_array([&](auto& array) {
    const std::vector<char>& bytes = file[next++];
    array.resize(bytes.size() / sizeof(array[0]));
    std::memcpy(static_cast<void*>(array.data()), bytes.data(), bytes.size());
  });
  EXPECT_TRUE(back.sound());
  EXPECT_EQ(back.triangle_count(), tree.triangle_count());
  EXPECT_EQ(features_of(back), features_of(tree));
}

TEST(SurfaceTree, KnowsDamagedArrays) {
  int arrays = 0;
  SurfaceTree(testing::box_mesh({1, 1, 1})).for_each_array([&](const auto&) { ++arrays; });
  for (int damaged = 0; damaged < arrays; ++damaged) {
    SurfaceTree tree(testing::torus(20, 10, 0.02, 0.006));
    ASSERT_TRUE(tree.sound());
    int at = 0;
    tree.for_each_array([&](auto& array) {
      if (at++ == damaged) array.pop_back();
    });
    EXPECT_FALSE(tree.sound()) << damaged;
  }
}

TEST(SurfaceTree, TakesMeshesThatAreNoSolids) {
  TriangleMesh mesh;  // three triangles on one edge, one of them twice, and a vertex of none
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0.5}, {0, 0, 1}, {5, 5, 5}};
  mesh.triangles = {{0, 1, 2}, {0, 1, 3}, {1, 0, 4}, {1, 0, 4}};
  const SurfaceTree tree(mesh);
  EXPECT_TRUE(tree.sound());
  EXPECT_EQ(tree.triangle_count(), 4);
  EXPECT_TRUE(SurfaceTree(TriangleMesh()).sound());
  EXPECT_TRUE(SurfaceTree(TriangleMesh()).empty());
}

}  // namespace
}  // namespace tactum::surface_tree_test
