#include "tactum/base/random.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace tactum {
namespace {

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

}  // namespace
}  // namespace tactum
