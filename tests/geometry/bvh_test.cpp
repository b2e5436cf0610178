#include "tactum/geometry/bvh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tactum/base/random.h"
#include "tactum/math/screw.h"

namespace tactum::bvh_test {
namespace {

Vec3 random_vector(Random& random, double size) {
  const double x = random.uniform(-size, size);
  const double y = random.uniform(-size, size);
  const double z = random.uniform(-size, size);
  return {x, y, z};
}

std::vector<Aabb> random_boxes(Random& random, int count) {
  std::vector<Aabb> boxes;
  for (int i = 0; i < count; ++i) {
    Aabb box;
    const Vec3 center = random_vector(random, 1.0);
    box.extend(center);
    box.extend(center + random_vector(random, 0.1));
    boxes.push_back(box);
  }
  return boxes;
}

int depth_below(const Bvh& bvh, int node) {
  const Bvh::Node& n = bvh.nodes()[static_cast<std::size_t>(node)];
  return n.leaf() ? 1 : 1 + std::max(depth_below(bvh, node + 1), depth_below(bvh, n.second));
}

TEST(Bvh, HoldsEveryItemOnceInsideEveryBoxAbove) {
  Random random(41);
  for (int count : {1, 2, 3, 100, 5000}) {
    const std::vector<Aabb> boxes = random_boxes(random, count);
    const Bvh bvh(boxes, 2);
    std::vector<std::int32_t> order = bvh.order();
    std::sort(order.begin(), order.end());
    for (int i = 0; i < count; ++i) EXPECT_EQ(order[static_cast<std::size_t>(i)], i);
    for (const Bvh::Node& node : bvh.nodes()) {
      if (!node.leaf()) continue;
      for (int i = node.second; i < node.second + node.count; ++i) {
        const Aabb& box = boxes[static_cast<std::size_t>(bvh.order()[static_cast<std::size_t>(i)])];
        EXPECT_TRUE(((node.center - node.half).array() <= box.min.array()).all());
        EXPECT_TRUE(((node.center + node.half).array() >= box.max.array()).all());
      }
    }
    EXPECT_LT(depth_below(bvh, 0), 40);
  }
}

TEST(Bvh, ManyEqualBoxesStayWithinTheDepth) {
  std::vector<Aabb> boxes(20000, Aabb{Vec3::Zero(), Vec3::Ones()});
  const Bvh same(boxes);
  EXPECT_LT(depth_below(same, 0), Bvh::kMaxDepth);
  // Positions that halve: the split by area peels off one at a time.
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const double x = std::ldexp(1.0, -static_cast<int>(i % 1000));
    boxes[i] = {Vec3(x, 0, 0), Vec3(x, 0, 0)};
  }
  EXPECT_LE(depth_below(Bvh(boxes), 0), Bvh::kMaxDepth);
}

double box_distance_sq(const Aabb& a, const Aabb& b) {
  return (a.min - b.max).cwiseMax(b.min - a.max).cwiseMax(0.0).squaredNorm();
}

TEST(Bvh, FindsAllPairsWithinTheTolerance) {
  const std::uint64_t seed = 42;
  Random random(seed);
  for (int round = 0; round < 40; ++round) {
    const std::vector<Aabb> boxes_a = random_boxes(random, 150);
    const std::vector<Aabb> boxes_b = random_boxes(random, 120);
    const Bvh a(boxes_a, 1 + round % 3);
    const Bvh b(boxes_b);
    const Vec3 shift = random_vector(random, 1.0);
    const double tolerance = round % 2 ? 0.05 : 0.0;
    // Pure translation: box distance is known in closed form.
    std::set<std::pair<int, int>> found;
    for_each_pair_within(a, b, {Mat3::Identity(), shift}, tolerance, [&](int i, int k) {
      found.insert({i, k});
      return true;
    });
    for (int i = 0; i < 150; ++i) {
      for (int k = 0; k < 120; ++k) {
        Aabb moved = boxes_b[static_cast<std::size_t>(k)];
        moved.min += shift;
        moved.max += shift;
        const double d_sq = box_distance_sq(boxes_a[static_cast<std::size_t>(i)], moved);
        EXPECT_TRUE(d_sq > tolerance * tolerance || found.contains({i, k}))
            << "seed " << seed << " round " << round;
      }
    }
    EXPECT_LT(found.size(), 150u * 120u / 10u);
  }
}

TEST(Bvh, GapIsALowerBoundWhateverTheTurn) {
  const std::uint64_t seed = 43;
  Random random(seed);
  for (int round = 0; round < 5000; ++round) {
    Bvh::Node a;
    Bvh::Node b;
    a.center = random_vector(random, 1.0);
    b.center = random_vector(random, 1.0);
    a.half = random_vector(random, 1.0).cwiseAbs();
    b.half = random_vector(random, 1.0).cwiseAbs();
    const Vec3 turn = random_vector(random, 3.0);
    const Pose X{round % 3 ? exp_rotation(turn) : Mat3::Identity(), random_vector(random, 3.0)};
    const BoxPairFrame frame(X);
    const double gap = box_gap(frame, a, b);
    double nearest = 1e300;  // over points of both boxes: an upper bound of the distance
    for (int i = 0; i < 50; ++i) {
      const Vec3 p = a.center + a.half.cwiseProduct(random_vector(random, 1.0));
      const Vec3 q = X * (b.center + b.half.cwiseProduct(random_vector(random, 1.0)));
      nearest = std::min(nearest, (p - q).norm());
    }
    EXPECT_LE(gap, nearest) << "seed " << seed << " round " << round;
    EXPECT_TRUE(boxes_within(frame, a, b, nearest)) << "seed " << seed << " round " << round;
  }
}

TEST(Bvh, TheVisitorStopsTheWalk) {
  Random random(44);
  const Bvh bvh(random_boxes(random, 100));
  int visits = 0;
  EXPECT_FALSE(for_each_pair_within(bvh, bvh, Pose{}, 1.0, [&](int, int) { return ++visits < 5; }));
  EXPECT_EQ(visits, 5);
  EXPECT_TRUE(for_each_pair_within(bvh, Bvh(), Pose{}, 1.0, [](int, int) { return true; }));
}

}  // namespace
}  // namespace tactum::bvh_test
