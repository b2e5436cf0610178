#include "tactum/base/static_vector.h"

#include <gtest/gtest.h>

namespace tactum {
namespace {

TEST(StaticVector, FillsRefusesAndEmpties) {
  StaticVector<int, 3> items;
  EXPECT_TRUE(items.empty());
  EXPECT_EQ(items.capacity(), 3u);
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(items.push_back(10 + i));
  EXPECT_TRUE(items.full());
  EXPECT_FALSE(items.push_back(99)) << "full";
  EXPECT_EQ(items.size(), 3u);
  EXPECT_EQ(items.back(), 12);
  int sum = 0;
  for (const int item : items) sum += item;
  EXPECT_EQ(sum, 33);
  items.pop_back();
  EXPECT_EQ(items.size(), 2u);
  EXPECT_TRUE(items.push_back(7));
  EXPECT_EQ(items[2], 7);
  items.clear();
  EXPECT_TRUE(items.empty());
  EXPECT_EQ(items.begin(), items.end());
}

/// Counts its constructions and copies.
struct Counted {
  static inline int made = 0;
  int value;
  explicit Counted(int of) : value(of) { ++made; }
  Counted(const Counted& other) : value(other.value) { ++made; }
  Counted& operator=(const Counted&) = default;
};

TEST(StaticVector, MakesAndCopiesOnlyWhatIsInUse) {
  Counted::made = 0;
  StaticVector<Counted, 100> items;
  EXPECT_EQ(Counted::made, 0);
  items.push_back(Counted(5));
  items.push_back(Counted(6));
  Counted::made = 0;
  StaticVector<Counted, 100> copy(items);
  EXPECT_EQ(Counted::made, 2);
  EXPECT_EQ(copy.size(), 2u);
  EXPECT_EQ(copy[1].value, 6);
  copy.push_back(Counted(7));
  items = copy;
  EXPECT_EQ(items.size(), 3u);
  EXPECT_EQ(items.back().value, 7);
}

#ifndef NDEBUG
TEST(StaticVectorDeathTest, IndexPastTheEndIsOurMistake) {
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  StaticVector<int, 3> items;
  EXPECT_DEATH(static_cast<void>(items[0]), "assertion failed: i < size_");
}
#endif

}  // namespace
}  // namespace tactum
