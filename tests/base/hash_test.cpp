#include "tactum/base/hash.h"

#include <gtest/gtest.h>

#include <string>

namespace tactum {
namespace {

std::uint64_t hash_of(const std::string& text) {
  Hash hash;
  hash.add_bytes(text.data(), text.size());
  return hash.value();
}

TEST(Hash, MatchesThePublishedTestVectorsOfFnv1a) {
  EXPECT_EQ(hash_of(""), 0xcbf29ce484222325ull);
  EXPECT_EQ(hash_of("a"), 0xaf63dc4c8601ec8cull);
  EXPECT_EQ(hash_of("foobar"), 0x85944171f73967e8ull);
}

std::uint64_t hash_of_numbers(double first, double second) {
  Hash hash;
  hash.add(first);
  hash.add(second);
  return hash.value();
}

TEST(Hash, NumbersCountByTheirBitsAndTheirOrder) {
  EXPECT_EQ(hash_of_numbers(1.0, 2.0), hash_of_numbers(1.0, 2.0));
  EXPECT_NE(hash_of_numbers(1.0, 2.0), hash_of_numbers(2.0, 1.0));
  EXPECT_NE(hash_of_numbers(0.0, 1.0), hash_of_numbers(-0.0, 1.0));
}

TEST(Hash, EveryBitOfANumberIsInEveryHalfOfTheHash) {
  for (int bit = 0; bit < 64; ++bit) {
    Hash one;
    Hash other;
    one.add(std::uint64_t{0x0123456789abcdef});
    other.add(std::uint64_t{0x0123456789abcdef} ^ std::uint64_t{1} << bit);
    one.add(7);  // one more number spreads what the highest bits of the last one changed
    other.add(7);
    const std::uint64_t changed = one.value() ^ other.value();
    EXPECT_NE(changed >> 32, 0u) << "bit " << bit;
    EXPECT_NE(changed & 0xffffffffu, 0u) << "bit " << bit;
  }
}

}  // namespace
}  // namespace tactum
