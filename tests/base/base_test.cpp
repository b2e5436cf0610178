#include <gtest/gtest.h>

#include <cstdint>
#include <cstdio>
#include <memory>
#include <thread>

#include "tactum/base/assert.h"
#include "tactum/base/frame_arena.h"
#include "tactum/base/hash.h"
#include "tactum/base/random.h"
#include "tactum/base/result.h"
#include "tactum/base/spsc_ring.h"
#include "tactum/base/static_vector.h"

namespace tactum {
namespace {

TEST(Result, MessageTellsWhereWhatFoundAndExpected) {
  const Error full{"cannot read the mesh", "7 numbers", "a multiple of 3", "part.obj:12"};
  EXPECT_EQ(full.message(), "part.obj:12: cannot read the mesh: found 7 numbers, expected a multiple of 3");
  EXPECT_EQ((Error{"no device", "", "", ""}).message(), "no device");
  EXPECT_EQ((Error{"no rate", "", "1 to 4000", ""}).message(), "no rate: expected 1 to 4000");
}

TEST(Result, HoldsTheValueOrTheError) {
  Result<std::unique_ptr<int>> good(std::make_unique<int>(5));
  ASSERT_TRUE(good);
  const std::unique_ptr<int> taken = *std::move(good);
  EXPECT_EQ(*taken, 5);
  const Result<int> bad(Error{"no", "", "", ""});
  ASSERT_FALSE(bad);
  EXPECT_EQ(bad.error().what, "no");
  EXPECT_TRUE(Result<void>());
  EXPECT_FALSE(Result<void>(Error{"no", "", "", ""}));
}

TEST(Hash, IsFnv1a) {  // the published values of the 64-bit function
  Hash hash;
  EXPECT_EQ(hash.value(), 0xcbf29ce484222325ull);
  hash.add_bytes("foobar", 6);
  EXPECT_EQ(hash.value(), 0x85944171f73967e8ull);
}

TEST(Hash, TellsMinusZeroFromZero) {
  Hash plus;
  Hash minus;
  plus.add(0.0);
  minus.add(-0.0);
  EXPECT_NE(plus.value(), minus.value());
}

TEST(Random, IsSplitMix64) {  // the first numbers of the published generator, from seed 1234567
  Random random(1234567);
  EXPECT_EQ(random.bits(), 6457827717110365317ull);
  EXPECT_EQ(random.bits(), 3203168211198807973ull);
  EXPECT_EQ(random.bits(), 9817491932198370423ull);
}

TEST(Random, UnitIsUniformInItsRange) {
  const std::uint64_t seed = 7;
  Random random(seed);
  double sum = 0.0;
  for (int i = 0; i < 100000; ++i) {
    const double u = random.unit();
    ASSERT_TRUE(u >= 0.0 && u < 1.0) << "seed " << seed;
    sum += u;
  }
  EXPECT_NEAR(sum / 100000, 0.5, 0.005) << "seed " << seed;
}

TEST(FrameArena, AlignsRefusesAndForgets) {
  FrameArena arena(64);
  const auto chars = arena.take<char>(3);
  const auto doubles = arena.take<double>(4);
  ASSERT_EQ(chars.size(), 3u);
  ASSERT_EQ(doubles.size(), 4u);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(doubles.data()) % alignof(double), 0u);
  EXPECT_EQ(arena.used(), 40u);
  EXPECT_TRUE(arena.take<double>(4).empty());
  EXPECT_TRUE(arena.take<double>(SIZE_MAX / 4).empty());  // a size that would wrap
  EXPECT_EQ(arena.refused(), 2u);
  EXPECT_EQ(arena.take<double>(3).size(), 3u);
  arena.reset();
  EXPECT_EQ(arena.used(), 0u);
  EXPECT_EQ(arena.peak(), 64u);
}

TEST(StaticVector, RefusesWhatDoesNotFit) {
  StaticVector<int, 2> items;
  EXPECT_TRUE(items.push_back(1));
  EXPECT_TRUE(items.push_back(2));
  EXPECT_TRUE(items.full());
  EXPECT_FALSE(items.push_back(3));
  EXPECT_EQ(items.back(), 2);
  items.pop_back();
  EXPECT_EQ(items.size(), 1u);
}

TEST(SpscRing, IsFullAtItsCapacityAndKeepsTheOrder) {
  SpscRing<int> ring(5);
  ASSERT_EQ(ring.capacity(), 8u);
  int out = 0;
  EXPECT_FALSE(ring.pop(out));
  for (int round = 0; round < 3; ++round) {
    for (int i = 0; i < 8; ++i) EXPECT_TRUE(ring.push(i));
    EXPECT_FALSE(ring.push(8));
    for (int i = 0; i < 8; ++i) {
      ASSERT_TRUE(ring.pop(out));
      EXPECT_EQ(out, i);
    }
  }
}

// Two words that must agree: a torn or early read would show.
struct Pair {
  std::uint64_t a;
  std::uint64_t b;
};

TEST(SpscRing, TwoThreadsLoseNothingAndTearNothing) {
  constexpr std::uint64_t kCount = 200000;
  SpscRing<Pair> ring(64);
  std::thread producer([&ring] {
    for (std::uint64_t i = 0; i < kCount;) {
      if (ring.push({i, ~i}))
        ++i;
      else
        std::this_thread::yield();
    }
  });
  std::uint64_t wrong = 0;
  for (std::uint64_t i = 0; i < kCount;) {
    Pair pair{};
    if (!ring.pop(pair)) {
      std::this_thread::yield();
      continue;
    }
    if (pair.a != i || pair.b != ~i) ++wrong;
    ++i;
  }
  producer.join();
  EXPECT_EQ(wrong, 0u);
}

void say_limp(void* context) noexcept { std::fputs(static_cast<const char*>(context), stderr); }

TEST(AssertDeathTest, CallsTheZeroWrenchHookFirst) {
  static char text[] = "zero wrench. ";
  EXPECT_DEATH(
      {
        set_zero_wrench_hook(say_limp, text);
        TACTUM_DEMAND(1 + 1 == 3);
      },
      "zero wrench. tactum: assertion failed: 1 \\+ 1 == 3");
}

TEST(Assert, DemandThatHoldsDoesNothing) { TACTUM_DEMAND(1 + 1 == 2); }

}  // namespace
}  // namespace tactum
