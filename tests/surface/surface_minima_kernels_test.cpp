/// The quick tests of the query surface against surface give the same, bit by bit, four lanes at a time and
/// eight.

#include <gtest/gtest.h>

#include <bit>
#include <cstdio>
#include <cstring>

#include "collision/cases.h"
#include "support/sample_meshes.h"
#include "support/surface_shapes.h"
#include "tactum/surface/surface_minima.h"
#include "tactum/surface/surface_minima_leaves.h"

namespace tactum {
namespace {

using lanes::Kernels;
using lanes::Lanes3;
using lanes::Three;

constexpr lanes::Bounds kBounds = {1e-3F, 2e-4F, 1e-3F, 4e-3F, 1e-7F};

class Draw {
 public:
  explicit Draw(std::uint64_t seed) : random_(seed) {}
  float number(double low, double high) { return static_cast<float>(random_.uniform(low, high)); }
  Three three(double largest) {
    return {number(-largest, largest), number(-largest, largest), number(-largest, largest)};
  }
  template <class Number>
  void fill(std::array<std::array<Number, lanes::kLanes>, 3>& v, double largest) {
    for (auto& axis : v) {
      for (Number& x : axis) x = static_cast<Number>(random_.uniform(-largest, largest));
    }
  }
  /// Axes of a box, the third along `up`.
  std::array<Three, 3> axes() {
    const Mat3 R = cases::random_rotation(random_);
    std::array<Three, 3> axis{};
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) axis[std::size_t(i)][std::size_t(k)] = static_cast<float>(R(k, i));
    }
    return axis;
  }
  SurfaceTree::Node node() {
    SurfaceTree::Node node;
    fill(node.at.center, 5e-3);
    for (std::size_t lane = 0; lane < lanes::kLanes; ++lane) {
      const std::array<Three, 3> axis = axes();
      for (std::size_t k = 0; k < 3; ++k) {
        node.at.along[k][lane] = axis[0][k];
        node.at.across[k][lane] = axis[1][k];
        node.at.up[k][lane] = axis[2][k];
        node.half[k][lane] = number(0.0, 3e-3);
      }
      node.cone[lane] = number(0.0, 2.0);
      node.child[lane] = number(0.0, 1.0) < 0.8F ? -1 : 0;
    }
    return node;
  }
  SurfaceTree::Corners corners() {
    SurfaceTree::Corners corner{};
    for (std::int32_t& c : corner) c = number(0.0, 1.0) < 0.9F ? 1 : -1;
    return corner;
  }
  lanes::VertexLeaf vertices() {
    lanes::VertexLeaf leaf{};
    fill(leaf.point, 2e-3);
    leaf.corner = corners();
    return leaf;
  }
  lanes::EdgeLeaf edges() {
    lanes::EdgeLeaf leaf{};
    fill(leaf.point, 2e-3);
    fill(leaf.along, 3e-3);
    for (Lanes3& falling : leaf.falling) fill(falling, 1.0);
    leaf.corner = corners();
    return leaf;
  }
  lanes::FaceLeaf faces() {
    lanes::FaceLeaf leaf{};
    fill(leaf.normal, 1.0);
    for (float& level : leaf.level) level = number(-1e-3, 1e-3);
    for (std::size_t k = 0; k < 3; ++k) {
      fill(leaf.inward[k], 1.0);
      for (float& limit : leaf.limit[k]) limit = number(-1e-3, 0.0);
    }
    leaf.corner = corners();
    return leaf;
  }

 private:
  Random random_;
};

/// No match is of a lane without a feature.
void expect_of_features(lanes::Matches matches, const SurfaceTree::Corners& ones,
                        const SurfaceTree::Corners& others) {
  for (; matches != 0; matches &= matches - 1) {
    const auto bit = std::size_t(std::countr_zero(matches));
    EXPECT_GE(ones[bit / lanes::kLanes], 0);
    EXPECT_GE(others[bit % lanes::kLanes], 0);
  }
}

TEST(SurfaceMinimaKernels, TellTheSameOfBoxesInFourLanesAndInEight) {
  const Kernels* wide = lanes::builds().usable_wide();
  if (!wide) GTEST_SKIP() << "this processor has no AVX2: nothing to compare";
  const Kernels& narrow = *lanes::builds().narrow;
  Draw draw(31);
  int set = 0;
  constexpr int kRounds = 20000;
  for (int i = 0; i < kRounds; ++i) {
    const SurfaceTree::Node other = draw.node();
    const SurfaceTree::Node node = draw.node();
    const lanes::Box box = {&other, &other.at, std::size_t(i) % lanes::kLanes};
    const std::uint32_t bits = narrow.facing(box, node, node.at, kBounds);
    ASSERT_EQ(bits, wide->facing(box, node, node.at, kBounds)) << "round " << i;
    for (std::size_t lane = 0; lane < lanes::kLanes; ++lane) {
      EXPECT_TRUE((bits >> lane & 1u) == 0 || node.child[lane] != 0);
    }
    set += std::popcount(bits);
  }
  EXPECT_GT(set, kRounds / 10);
  EXPECT_LT(set, 4 * kRounds);
}

TEST(SurfaceMinimaKernels, TellTheSameOfFeaturesInFourLanesAndInEight) {
  const Kernels* wide = lanes::builds().usable_wide();
  if (!wide) GTEST_SKIP() << "this processor has no AVX2: nothing to compare";
  const Kernels& narrow = *lanes::builds().narrow;
  Draw draw(32);
  std::array<int, 4> set{};
  constexpr int kRounds = 20000;
  for (int i = 0; i < kRounds; ++i) {
    const SurfaceTree::Node node = draw.node();
    const lanes::Box box = {&node, &node.at, 2};
    const lanes::Box other = {&node, &node.at, 5};
    const Three off = draw.three(1e-3);
    const lanes::VertexLeaf vertices = draw.vertices();
    const std::uint32_t some = narrow.vertices_near(vertices, off, box, kBounds);
    EXPECT_EQ(some, wide->vertices_near(vertices, off, box, kBounds));
    const auto same = [&](auto test, const auto& of, int& count) {
      const lanes::Matches four = (narrow.*test)(vertices, some, off, of, kBounds);
      EXPECT_EQ(four, (wide->*test)(vertices, some, off, of, kBounds));
      expect_of_features(four, vertices.corner, of.corner);
      count += std::popcount(four);
    };
    same(&Kernels::vertex_vertex, draw.vertices(), set[0]);
    same(&Kernels::vertex_edge, draw.edges(), set[1]);
    same(&Kernels::vertex_face, draw.faces(), set[2]);
    const lanes::EdgeLeaf edges = draw.edges();
    const lanes::EdgeLeaf many = draw.edges();
    const std::uint32_t some_edges = narrow.edges_near(edges, off, box, kBounds);
    EXPECT_EQ(some_edges, wide->edges_near(edges, off, box, kBounds));
    const std::uint32_t others = narrow.edges_near(many, draw.three(1e-3), other, kBounds);
    const lanes::Matches four = narrow.edge_edge(edges, some_edges, off, many, others, kBounds);
    EXPECT_EQ(four, wide->edge_edge(edges, some_edges, off, many, others, kBounds));
    expect_of_features(four, edges.corner, many.corner);
    set[3] += std::popcount(four);
  }
  for (int count : set) {
    EXPECT_GT(count, 0);
    EXPECT_LT(count, 40 * kRounds);
  }
}

TEST(SurfaceMinimaKernels, TurnAndLayOutTheSameInFourLanesAndInEight) {
  const Kernels* wide = lanes::builds().usable_wide();
  if (!wide) GTEST_SKIP() << "this processor has no AVX2: nothing to compare";
  const Kernels& narrow = *lanes::builds().narrow;
  Draw draw(34);
  Random random(35);
  for (int i = 0; i < 1000; ++i) {
    const lanes::Frame frame({cases::random_rotation(random), cases::random_vector(random, 0.1)});
    const SurfaceTree::Node node = draw.node();
    const auto same = [&](const auto& turn, const auto& from) {
      auto four = from;
      auto eight = from;
      turn(narrow, four);
      turn(*wide, eight);
      EXPECT_EQ(std::memcmp(&four, &eight, sizeof four), 0);
      EXPECT_NE(std::memcmp(&four, &from, sizeof four), 0);
    };
    same([&](const Kernels& kernels, auto& to) { kernels.turn_stand(node.at, frame, to); }, node.at);
    same([&](const Kernels& kernels, auto& to) { kernels.turn_vertices(frame, to); }, draw.vertices());
    same([&](const Kernels& kernels, auto& to) { kernels.turn_edges(frame, to); }, draw.edges());
    std::array<lanes::Points, 4> points{};
    for (lanes::Points& point : points) draw.fill(point, 3e-3);
    same([&](const Kernels& kernels, auto& to) { kernels.lay_edges(points, to); }, draw.edges());
    same(
        [&](const Kernels& kernels, auto& to) {
          kernels.lay_faces({points[0], points[1], points[2]}, 1e-7F, to);
        },
        draw.faces());
  }
}

/// The leaves' lanes agree with the mesh's features.
TEST(SurfaceMinimaKernels, LayLeavesOutAsTheMeshSays) {
  Random random(2);
  const SurfaceTree tree(testing::bumpy_sheet(random, 9, 0.03, 1e-3));
  const double near = 1e-6 * tree.size();
  const auto at_lane = [](const Lanes3& v, std::size_t lane) {
    return Vec3(v[0][lane], v[1][lane], v[2][lane]);
  };
  int features = 0;
  for (const SurfaceTree::Node& node : tree.nodes()) {
    const auto index = static_cast<std::int32_t>(&node - tree.nodes().data());
    for (std::size_t box_lane = 0; box_lane < lanes::kLanes; ++box_lane) {
      if (node.child[box_lane] >= 0) continue;
      const lanes::Box box = {&node, &node.at, box_lane};
      const Vec3 middle = tree.center() + at_lane(node.at.center, box_lane);
      const auto corner = [&](std::int32_t c, std::size_t after) {
        return Vec3(tree.vertex(tree.triangle(c / 3)[(std::size_t(c) + after) % 3]) - middle);
      };
      lanes::VertexLeaf vertices;
      lanes::EdgeLeaf edges;
      lanes::FaceLeaf faces;
      lanes::gather_leaf(tree, box, vertices);
      lanes::gather_leaf(tree, box, lanes::builds().best(), edges);
      lanes::gather_leaf(tree, box, lanes::builds().best(), 0.0F, faces);
      for (std::size_t lane = 0; lane < lanes::kLanes; ++lane) {
        const std::int32_t c = tree.leaves()[lanes::leaf_under(box)][lane];
        ASSERT_EQ(vertices.corner[lane], c);
        ASSERT_EQ(edges.corner[lane], c);
        ASSERT_EQ(faces.corner[lane], c);
        if (c < 0) continue;
        ++features;
        EXPECT_LT((at_lane(vertices.point, lane) - corner(c, 0)).norm(), near);
        const Vec3 along = corner(c, 1) - corner(c, 0);
        EXPECT_LT((at_lane(edges.point, lane) - corner(c, 0)).norm(), near);
        EXPECT_LT((at_lane(edges.along, lane) - along).norm(), near);
        for (std::size_t k = 0; k < 2; ++k) {
          const std::int32_t beyond = tree.beyond(c);
          const Vec3 to_other = k == 0 || beyond == SurfaceTree::kWall
                                    ? Vec3(corner(c, 2) - corner(c, 0))
                                    : Vec3(tree.vertex(beyond) - middle - corner(c, 0));
          const Vec3 falling = at_lane(edges.falling[k], lane);
          EXPECT_NEAR(falling.norm(), 1.0, 1e-6);
          EXPECT_NEAR(falling.dot(along.normalized()), 0.0, 1e-6);
          EXPECT_NEAR(falling.dot(to_other), to_other.cross(along.normalized()).norm(), near);
        }
        if (index < tree.root(SurfaceTree::kFaces)) continue;
        const Vec3 inside = (corner(c, 0) + corner(c, 1) + corner(c, 2)) / 3.0;
        for (std::size_t k = 0; k < 3; ++k) {
          EXPECT_NEAR(at_lane(faces.normal, lane).dot(corner(c, k)), faces.level[lane], near);
          const Vec3 inward = at_lane(faces.inward[k], lane);
          EXPECT_NEAR(inward.dot(corner(c, k)), faces.limit[k][lane], near);
          EXPECT_NEAR(inward.dot(corner(c, k + 1)), faces.limit[k][lane], near);
          EXPECT_GT(inward.dot(inside), faces.limit[k][lane]);
        }
      }
    }
  }
  EXPECT_GT(features, 2 * tree.triangle_count());
}

TEST(SurfaceMinimaKernels, FindTheSameMinimaInFourLanesAndInEight) {
  const Kernels* wide = lanes::builds().usable_wide();
  if (!wide) GTEST_SKIP() << "this processor has no AVX2: nothing to compare";
  testing::Thread shape;
  const SurfaceTree bolt(testing::thread_mesh(shape));
  shape.inner = true;
  shape.offset = 1e-4;
  const SurfaceTree nut(testing::thread_mesh(shape));
  const MinimaQuery query{2e-4, 1e-5, 4e-3};
  Random random(33);
  std::array<std::vector<SurfaceMinimum>, 2> found;
  for (auto& minima : found) minima.reserve(1 << 14);
  int minima = 0;
  for (int i = 0; i < 20; ++i) {
    Pose X;
    for (int k = 0; k < 3; ++k) X.p[k] = random.uniform(-5e-5, 5e-5);
    const MinimaWork four = lanes::surface_minima(*lanes::builds().narrow, bolt, nut, X, query, found[0]);
    const MinimaWork eight = lanes::surface_minima(*wide, bolt, nut, X, query, found[1]);
    EXPECT_EQ(four.box_tests, eight.box_tests);
    EXPECT_EQ(four.leaf_pairs, eight.leaf_pairs);
    EXPECT_EQ(four.feature_pairs, eight.feature_pairs);
    ASSERT_EQ(found[0].size(), found[1].size());
    for (std::size_t m = 0; m < found[0].size(); ++m) {
      const SurfaceMinimum& x = found[0][m];
      const SurfaceMinimum& y = found[1][m];
      EXPECT_TRUE(x.a == y.a && x.b == y.b && x.distance == y.distance && x.p_a == y.p_a && x.p_b == y.p_b &&
                  x.normal == y.normal && x.strict == y.strict);
    }
    minima += static_cast<int>(found[0].size());
  }
  EXPECT_GT(minima, 1000);
}

}  // namespace
}  // namespace tactum
