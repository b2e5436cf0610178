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

TEST(Hash, NumbersAreTheirBytesInOrder) {
  Hash whole;
  whole.add(0x6f6f66);  // "foo\0" on a little-endian machine
  EXPECT_EQ(whole.value(), hash_of(std::string("foo\0", 4)));
  Hash ab;
  ab.add(1.0);
  ab.add(2.0);
  Hash ba;
  ba.add(2.0);
  ba.add(1.0);
  EXPECT_NE(ab.value(), ba.value());
  Hash positive;
  positive.add(0.0);
  Hash negative;
  negative.add(-0.0);
  EXPECT_NE(positive.value(), negative.value()) << "bits, not values";
}

}  // namespace
}  // namespace tactum
