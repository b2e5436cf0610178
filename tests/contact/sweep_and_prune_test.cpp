#include "tactum/contact/sweep_and_prune.h"

#include <gtest/gtest.h>

#include <set>

#include "tactum/base/random.h"

namespace tactum {
namespace {

Aabb random_box(Random& random, double grid) {
  Aabb box;
  for (int axis = 0; axis < 3; ++axis) {
    // A coarse grid makes ends coincide often: touching boxes must count as overlapping.
    box.min[axis] = std::floor(random.uniform(0, 10) / grid) * grid;
    box.max[axis] = box.min[axis] + std::floor(random.uniform(0, 4) / grid) * grid;
  }
  return box;
}

std::set<std::pair<int, int>> scan(const std::vector<Aabb>& boxes) {
  std::set<std::pair<int, int>> pairs;
  for (int a = 0; a < int(boxes.size()); ++a)
    for (int b = a + 1; b < int(boxes.size()); ++b)
      if (boxes[std::size_t(a)].overlaps(boxes[std::size_t(b)])) pairs.insert({a, b});
  return pairs;
}

std::set<std::pair<int, int>> listed(const SweepAndPrune& sweep) {
  std::set<std::pair<int, int>> pairs;
  for (const auto& pair : sweep.pairs()) EXPECT_TRUE(pairs.insert({pair.a, pair.b}).second) << "listed twice";
  return pairs;
}

TEST(SweepAndPrune, ListsWhatAScanFindsWhileBoxesMove) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    const double grid = seed % 2 ? 1.0 : 0.001;
    std::vector<Aabb> boxes;
    const int n = 2 + random.index(40);
    for (int i = 0; i < n; ++i) boxes.push_back(random_box(random, grid));
    SweepAndPrune sweep(boxes);
    EXPECT_EQ(listed(sweep), scan(boxes)) << "seed " << seed;
    for (int step = 0; step < 300; ++step) {
      for (int k = random.index(n); k >= 0; --k) {
        const int i = random.index(n);
        boxes[std::size_t(i)] = random_box(random, grid);
        sweep.move(i, boxes[std::size_t(i)]);
      }
      sweep.update();
      ASSERT_EQ(listed(sweep), scan(boxes)) << "seed " << seed << " step " << step;
    }
  }
}

TEST(SweepAndPrune, NothingMovedCostsNoSwap) {
  Random random(5);
  std::vector<Aabb> boxes;
  for (int i = 0; i < 50; ++i) boxes.push_back(random_box(random, 0.001));
  SweepAndPrune sweep(boxes);
  EXPECT_EQ(sweep.update(), 0);
  SweepAndPrune one({boxes[0]});
  EXPECT_EQ(one.update(), 0);
  EXPECT_TRUE(one.pairs().empty());
}

}  // namespace
}  // namespace tactum
