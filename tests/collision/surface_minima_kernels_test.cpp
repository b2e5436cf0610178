/// The quick tests of the query surface against surface tell the same, bit by bit, four lanes at a time and
/// eight.

#include <gtest/gtest.h>

#include <bit>
#include <cstdio>

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
  lanes::Box box() {
    lanes::Box box{three(5e-3), axes(), {}, number(0.0, 2.0), {}};
    for (float& h : box.half) h = number(0.0, 3e-3);
    box.pad = {number(0.0, 1e-3), 1e-3F, 2e-4F};
    return box;
  }
  SurfaceTree::Node node() {
    SurfaceTree::Node node;
    fill(node.center, 5e-3);
    for (std::size_t lane = 0; lane < lanes::kLanes; ++lane) {
      const std::array<Three, 3> axis = axes();
      for (std::size_t k = 0; k < 3; ++k) {
        node.along[k][lane] = axis[0][k];
        node.up[k][lane] = axis[2][k];
        node.half[k][lane] = number(0.0, 3e-3);
      }
      node.cone[lane] = number(0.0, 2.0);
      node.child[lane] = number(0.0, 1.0) < 0.8F ? -1 : 0;
    }
    return node;
  }

 private:
  Random random_;
};

lanes::Faces faces_of(Draw& draw) {
  lanes::Faces faces{};
  draw.fill(faces.normal, 1.0);
  for (float& level : faces.level) level = draw.number(-1e-3, 1e-3);
  for (std::size_t k = 0; k < 3; ++k) {
    draw.fill(faces.inward[k], 1e-3);
    for (float& limit : faces.limit[k]) limit = draw.number(-1e-6, 0.0);
  }
  return faces;
}

TEST(SurfaceMinimaKernels, TellTheSameOfBoxesInFourLanesAndInEight) {
  const Kernels* wide = lanes::wide_kernels();
  if (!wide) GTEST_SKIP() << "this processor has no AVX2: nothing to compare";
  const Kernels& narrow = lanes::narrow_kernels();
  Draw draw(31);
  int set = 0;
  constexpr int kRounds = 20000;
  for (int i = 0; i < kRounds; ++i) {
    const lanes::Box box = draw.box();
    const SurfaceTree::Node node = draw.node();
    const std::uint32_t bits = narrow.facing(box, node, kBounds);
    ASSERT_EQ(bits, wide->facing(box, node, kBounds)) << "round " << i;
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
  std::array<int, 6> set{};
  constexpr int kRounds = 5000;
  for (int i = 0; i < kRounds; ++i) {
    lanes::Vertices vertices{};
    lanes::Vertices others{};
    lanes::Edges edges{};
    lanes::Edges many{};
    draw.fill(vertices.point, 2e-3);
    draw.fill(others.point, 2e-3);
    draw.fill(edges.point, 2e-3);
    draw.fill(edges.along, 3e-3);
    draw.fill(many.point, 2e-3);
    draw.fill(many.along, 3e-3);
    const lanes::Faces faces = faces_of(draw);
    const Three off = draw.three(1e-3);
    const lanes::Box box = draw.box();
    const std::uint32_t near = narrow.vertices_near(vertices, off, box);
    const std::uint32_t near_edges = narrow.edges_near(edges, off, box);
    ASSERT_EQ(near, wide->vertices_near(vertices, off, box));
    ASSERT_EQ(near_edges, wide->edges_near(edges, off, box));
    set[0] += std::popcount(near);
    set[1] += std::popcount(near_edges);
    const auto same = [&](auto test, const auto& ones, const auto& of, int& count) {
      lanes::Matches four{};
      lanes::Matches eight{};
      (narrow.*test)(ones, off, 0xA7u, of, kBounds, four);
      (wide->*test)(ones, off, 0xA7u, of, kBounds, eight);
      EXPECT_EQ(four, eight);
      for (std::uint8_t bits : four) count += std::popcount(bits);
    };
    same(&Kernels::vertex_vertex, vertices, others, set[2]);
    same(&Kernels::vertex_edge, vertices, many, set[3]);
    same(&Kernels::vertex_face, vertices, faces, set[4]);
    same(&Kernels::edge_edge, edges, many, set[5]);
  }
  for (int count : set) {
    EXPECT_GT(count, 0);
    EXPECT_LT(count, 40 * kRounds);
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
