#include "tactum/base/frame_arena.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

namespace tactum {
namespace {

TEST(FrameArena, HandsOutAlignedRoomThatDoesNotOverlap) {
  FrameArena arena(256);
  const std::span<char> bytes = arena.take<char>(3);
  const std::span<double> numbers = arena.take<double>(4);
  ASSERT_EQ(bytes.size(), 3u);
  ASSERT_EQ(numbers.size(), 4u);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(numbers.data()) % alignof(double), 0u);
  EXPECT_GE(reinterpret_cast<char*>(numbers.data()), bytes.data() + bytes.size());
  for (double& number : numbers) number = 1.5;
  EXPECT_EQ(arena.used(), 8 + 4 * sizeof(double));
}

TEST(FrameArena, RefusesWhatDoesNotFitAndCountsIt) {
  FrameArena arena(64);
  EXPECT_EQ(arena.take<double>(8).size(), 8u) << "exactly full";
  EXPECT_TRUE(arena.take<char>(1).empty());
  EXPECT_TRUE(arena.take<double>(std::numeric_limits<std::size_t>::max()).empty()) << "no overflow";
  EXPECT_EQ(arena.refused(), 2u);
  EXPECT_EQ(arena.used(), 64u) << "a refused take takes nothing";
}

TEST(FrameArena, ResetGivesTheSameRoomAgainAndKeepsThePeak) {
  FrameArena arena(128);
  const int* first = arena.take<int>(10).data();
  arena.reset();
  EXPECT_EQ(arena.used(), 0u);
  EXPECT_EQ(arena.take<int>(2).data(), first);
  EXPECT_EQ(arena.peak(), 10 * sizeof(int));
}

}  // namespace
}  // namespace tactum
