#include "tactum/base/parallel.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <stdexcept>
#include <string>

namespace tactum {
namespace {

TEST(Parallel, EveryItemIsWorkedOnOnceByAnyNumberOfThreads) {
  for (int threads : {-1, 0, 1, 2, 3, 7, 40}) {
    for (std::size_t count : {0U, 1U, 9U, 10U, 11U, 1000U}) {
      std::vector<int> visits(count, 0);
      for_ranges(threads, count, 10, [&](std::size_t first, std::size_t last) {
        EXPECT_EQ(first % 10, 0U);
        EXPECT_LE(last - first, 10U);
        for (std::size_t i = first; i < last; ++i) ++visits[i];
      });
      EXPECT_EQ(visits, std::vector<int>(count, 1)) << threads << " threads, " << count << " items";
    }
  }
}

TEST(Parallel, TheCallerGetsTheExceptionOfTheLowestRange) {
  for (int threads : {1, 2, 3, 7}) {
    for (int repeat = 0; repeat < 50; ++repeat) {
      try {
        for_ranges(threads, 100, 1, [](std::size_t i, std::size_t) {
          if (i >= 20 && i % 3 == 0) throw std::runtime_error(std::to_string(i));
        });
        FAIL() << "no exception with " << threads << " threads";
      } catch (const std::runtime_error& error) {
        EXPECT_STREQ(error.what(), "21") << threads << " threads";
      }
    }
  }
}

TEST(Parallel, WorkEndsAfterAnException) {
  std::atomic<int> ranges{0};
  EXPECT_THROW(for_ranges(2, 1000000, 1,
                          [&](std::size_t, std::size_t) {
                            ++ranges;
                            throw std::runtime_error("at once");
                          }),
               std::runtime_error);
  EXPECT_LE(ranges, 2);
}

TEST(Parallel, BothPartsShareTheThreads) {
  for (int threads : {-1, 0, 1, 2, 3, 7}) {
    std::array<int, 2> shares{};
    for_both(
        threads, [&](int share) { shares[0] = share; }, [&](int share) { shares[1] = share; });
    EXPECT_GE(shares[0], 1);
    EXPECT_GE(shares[1], 1);
    EXPECT_EQ(shares[0] + shares[1], std::max(threads, 2)) << threads << " threads";
  }
}

}  // namespace
}  // namespace tactum
