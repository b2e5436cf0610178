/// The quick tests of the query surface against surface tell the same, bit by bit, four lanes at a time and
/// eight.

#include <gtest/gtest.h>

#include <bit>
#include <cstdio>
#include <cstring>

#include "collision/cases.h"
#include "support/sample_meshes.h"
#include "support/surface_shapes.h"
#include "tactum/collision/surface_minima.h"
#include "tactum/collision/surface_minima_lanes.h"

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
  void fill(Lanes3& v, double largest) {
    for (lanes::Lanes& axis : v) {
      for (float& x : axis) x = number(-largest, largest);
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
  SurfaceTree::VertexLeaf vertices() {
    SurfaceTree::VertexLeaf leaf{};
    fill(leaf.point, 2e-3);
    leaf.corner = corners();
    return leaf;
  }
  SurfaceTree::EdgeLeaf edges() {
    SurfaceTree::EdgeLeaf leaf{};
    fill(leaf.point, 2e-3);
    fill(leaf.along, 3e-3);
    leaf.corner = corners();
    return leaf;
  }
  SurfaceTree::FaceLeaf faces() {
    SurfaceTree::FaceLeaf leaf{};
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
  const Kernels* wide = lanes::wide_kernels();
  if (!wide) GTEST_SKIP() << "this processor has no AVX2: nothing to compare";
  const Kernels& narrow = lanes::narrow_kernels();
  Draw draw(31);
  int set = 0;
  constexpr int kRounds = 20000;
  for (int i = 0; i < kRounds; ++i) {
    const SurfaceTree::Node held = draw.node();
    const SurfaceTree::Node node = draw.node();
    const lanes::Box box = {&held, &held.at, std::size_t(i) % lanes::kLanes};
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
  const Kernels* wide = lanes::wide_kernels();
  if (!wide) GTEST_SKIP() << "this processor has no AVX2: nothing to compare";
  const Kernels& narrow = lanes::narrow_kernels();
  Draw draw(32);
  std::array<int, 4> set{};
  constexpr int kRounds = 20000;
  for (int i = 0; i < kRounds; ++i) {
    const SurfaceTree::Node node = draw.node();
    const lanes::Box box = {&node, &node.at, 2};
    const lanes::Box other = {&node, &node.at, 5};
    const Three off = draw.three(1e-3);
    const SurfaceTree::VertexLeaf vertices = draw.vertices();
    const auto same = [&](auto test, const auto& of, int& count) {
      const lanes::Matches four = (narrow.*test)(vertices, off, box, of, kBounds);
      EXPECT_EQ(four, (wide->*test)(vertices, off, box, of, kBounds));
      expect_of_features(four, vertices.corner, of.corner);
      count += std::popcount(four);
    };
    same(&Kernels::vertex_vertex, draw.vertices(), set[0]);
    same(&Kernels::vertex_edge, draw.edges(), set[1]);
    same(&Kernels::vertex_face, draw.faces(), set[2]);
    const SurfaceTree::EdgeLeaf edges = draw.edges();
    const SurfaceTree::EdgeLeaf many = draw.edges();
    const lanes::Matches four = narrow.edge_edge(edges, box, off, many, other, kBounds);
    EXPECT_EQ(four, wide->edge_edge(edges, box, off, many, other, kBounds));
    expect_of_features(four, edges.corner, many.corner);
    set[3] += std::popcount(four);
  }
  for (int count : set) {
    EXPECT_GT(count, 0);
    EXPECT_LT(count, 40 * kRounds);
  }
}

TEST(SurfaceMinimaKernels, TurnTheSameInFourLanesAndInEight) {
  const Kernels* wide = lanes::wide_kernels();
  if (!wide) GTEST_SKIP() << "this processor has no AVX2: nothing to compare";
  const Kernels& narrow = lanes::narrow_kernels();
  Draw draw(34);
  Random random(35);
  for (int i = 0; i < 1000; ++i) {
    const lanes::Frame frame({cases::random_rotation(random), cases::random_vector(random, 0.1)});
    const SurfaceTree::Node node = draw.node();
    const auto same = [&](auto turn, const auto& from) {
      auto four = from;
      auto eight = from;
      (narrow.*turn)(from, frame, four);
      (wide->*turn)(from, frame, eight);
      EXPECT_EQ(std::memcmp(&four, &eight, sizeof four), 0);
      EXPECT_NE(std::memcmp(&four, &from, sizeof four), 0);
    };
    same(&Kernels::turn_stand, node.at);
    same(&Kernels::turn_vertices, draw.vertices());
    same(&Kernels::turn_edges, draw.edges());
  }
}

TEST(SurfaceMinimaKernels, FindTheSameMinimaInFourLanesAndInEight) {
  const Kernels* wide = lanes::wide_kernels();
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
    const MinimaWork four = lanes::surface_minima(lanes::narrow_kernels(), bolt, nut, X, query, found[0]);
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
