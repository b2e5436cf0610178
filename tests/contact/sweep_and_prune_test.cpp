#include "tactum/contact/sweep_and_prune.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
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

/// Pairs keep their slot while they overlap, and no two have the same.
TEST(SweepAndPrune, SlotsAreOfOnePairEach) {
  Random random(7);
  std::vector<Aabb> boxes;
  for (int i = 0; i < 60; ++i) boxes.push_back(random_box(random, 0.001));
  SweepAndPrune sweep(boxes);
  std::map<std::pair<int, int>, int> before;
  for (int step = 0; step < 500; ++step) {
    const int i = random.index(60);
    sweep.move(i, random_box(random, 0.001));
    sweep.update();
    std::map<std::pair<int, int>, int> slots;
    std::set<int> used;
    for (const auto& pair : sweep.pairs()) {
      ASSERT_LT(pair.slot, int(sweep.room()));
      ASSERT_TRUE(used.insert(pair.slot).second) << "step " << step;
      slots[{pair.a, pair.b}] = pair.slot;
      const auto old = before.find({pair.a, pair.b});
      if (old != before.end()) {
        ASSERT_EQ(old->second, pair.slot) << "step " << step;
      }
    }
    before = slots;
  }
}

/// Where there is less room than there are pairs, the others are counted, and listed when there is room.
TEST(SweepAndPrune, PairsWithoutRoomAreCountedAndListedLater) {
  for (const std::size_t room : {std::size_t(0), std::size_t(1), std::size_t(20), std::size_t(200)}) {
    Random random(11);
    std::vector<Aabb> boxes;
    for (int i = 0; i < 40; ++i) boxes.push_back(random_box(random, 1.0));
    SweepAndPrune sweep(boxes, room);
    for (int step = 0; step < 400; ++step) {
      const auto all = scan(boxes);
      const auto some = listed(sweep);
      ASSERT_EQ(some.size() + std::size_t(sweep.missing()), all.size()) << "step " << step;
      ASSERT_EQ(some.size(), std::min(room, all.size()));
      ASSERT_TRUE(std::includes(all.begin(), all.end(), some.begin(), some.end()));
      for (int k = 0; k < 5; ++k) {
        const int i = random.index(40);
        boxes[std::size_t(i)] = random_box(random, step % 50 < 25 ? 1.0 : 4.0);
        sweep.move(i, boxes[std::size_t(i)]);
      }
      sweep.update();
    }
  }
}

TEST(SweepAndPrune, RoomGrowsWithTheBoxes) {
  for (const std::size_t boxes : {0, 1, 2, 3, 128})
    EXPECT_EQ(SweepAndPrune::room_for(boxes), boxes * (boxes + 1) / 2 - boxes);
  EXPECT_EQ(SweepAndPrune::room_for(1000), 64000u);
  EXPECT_EQ(SweepAndPrune::room_for(2000), 128000u);
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
