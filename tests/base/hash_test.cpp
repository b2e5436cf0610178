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

template <class AnyHash>
std::uint64_t hash_of_numbers(double first, double second) {
  AnyHash hash;
  hash.add(first);
  hash.add(second);
  return hash.value();
}

template <class AnyHash>
class NumberHash : public ::testing::Test {};
using NumberHashes = testing::Types<Hash, FrameHash>;
TYPED_TEST_SUITE(NumberHash, NumberHashes);

TYPED_TEST(NumberHash, NumbersCountByTheirBitsAndTheirOrder) {
  EXPECT_EQ(hash_of_numbers<TypeParam>(1.0, 2.0), hash_of_numbers<TypeParam>(1.0, 2.0));
  EXPECT_NE(hash_of_numbers<TypeParam>(1.0, 2.0), hash_of_numbers<TypeParam>(2.0, 1.0));
  EXPECT_NE(hash_of_numbers<TypeParam>(0.0, 1.0), hash_of_numbers<TypeParam>(-0.0, 1.0));
}

/// Of as many numbers as there are chains and more, each two change places.
TEST(FrameHash, EveryPlaceCounts) {
  const auto hash_of_ten = [](int one, int other) {
    FrameHash hash;
    for (int i = 0; i < 10; ++i) hash.add(i == one ? other : i == other ? one : i);
    return hash.value();
  };
  for (int one = 0; one < 10; ++one)
    for (int other = 0; other < one; ++other) EXPECT_NE(hash_of_ten(one, other), hash_of_ten(0, 0));
}

TYPED_TEST(NumberHash, EveryBitOfANumberIsInEveryHalfOfTheHash) {
  for (int bit = 0; bit < 64; ++bit) {
    TypeParam one;
    TypeParam other;
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
