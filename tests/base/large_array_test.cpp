#include "tactum/base/large_array.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>

namespace tactum {
namespace {

constexpr std::size_t kLargePage = std::size_t{2} << 20;

template <class T>
std::uintptr_t past(const LargeArray<T>& array, std::size_t boundary) {
  return reinterpret_cast<std::uintptr_t>(array.data()) % boundary;
}

TEST(LargeArray, BeginsOnACacheLineAndFromTwoMegabytesOnOnALargePage) {
  using Side = std::array<double, 6>;
  for (const std::size_t count : {1, 2, 3, 7, 100, 5000})
    EXPECT_EQ(past(LargeArray<Side>(count), 64), 0u) << count;
  EXPECT_EQ(past(LargeArray<char>(kLargePage - 1), 64), 0u);
  EXPECT_EQ(past(LargeArray<char>(kLargePage), kLargePage), 0u);
  EXPECT_EQ(past(LargeArray<Side>(100'000), kLargePage), 0u);
}

TEST(LargeArray, KeepsItsNumbersWhileItGrowsAndIsCopiedAndMoved) {
  LargeArray<int> grown;  // from small over the first large page, and on
  for (int i = 0; i < 2'000'000; ++i) grown.push_back(i);
  LargeArray<int> counted(grown.size());
  std::iota(counted.begin(), counted.end(), 0);
  EXPECT_EQ(grown, counted);
  const LargeArray<int> copy = grown;
  const LargeArray<int> moved = std::move(grown);
  EXPECT_EQ(copy, moved);
  EXPECT_EQ(moved.back(), 1'999'999);
  EXPECT_EQ(past(copy, kLargePage), 0u);
}

TEST(LargeArray, MoreThanThereCanBeIsRefused) {
  const std::size_t all = std::numeric_limits<std::size_t>::max();
  LargeArrayAllocator<double> memory;
  EXPECT_THROW(static_cast<void>(memory.allocate(all)), std::bad_alloc);
  EXPECT_THROW(static_cast<void>(memory.allocate(all / sizeof(double))), std::bad_alloc);
}

}  // namespace
}  // namespace tactum
