#include "tactum/base/spsc_ring.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <thread>

namespace tactum {
namespace {

TEST(SpscRing, KeepsOrderAndSaysWhenFullOrEmpty) {
  SpscRing<int> ring(5);
  EXPECT_EQ(ring.capacity(), 8u);
  int item = -1;
  EXPECT_FALSE(ring.pop(item));
  EXPECT_EQ(item, -1);
  int pushed = 0;
  int popped = 0;
  for (int round = 0; round < 100; ++round) {  // so that the indices go round many times
    while (ring.push(pushed)) ++pushed;
    EXPECT_EQ(pushed - popped, 8);
    for (int i = 0; i < 1 + round % 8; ++i) {
      ASSERT_TRUE(ring.pop(item));
      EXPECT_EQ(item, popped++);
    }
  }
}

TEST(SpscRing, TwoThreadsLoseNothingAndTearNothing) {
  struct Item {
    std::uint64_t number;
    std::uint64_t check;
  };
  constexpr std::uint64_t kItems = 200000;
  SpscRing<Item> ring(64);
  std::thread producer([&ring] {
    for (std::uint64_t i = 0; i < kItems; ++i) {
      while (!ring.push({i, ~i})) std::this_thread::yield();
    }
  });
  for (std::uint64_t i = 0; i < kItems; ++i) {
    Item item{};
    while (!ring.pop(item)) std::this_thread::yield();
    ASSERT_EQ(item.number, i);
    ASSERT_EQ(item.check, ~i);
  }
  producer.join();
  Item left{};
  EXPECT_FALSE(ring.pop(left));
}

}  // namespace
}  // namespace tactum
