#include "tactum/base/result.h"

#include <gtest/gtest.h>

#include <memory>
#include <utility>

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

/// In every build: access without a value means that the caller did not check.
TEST(Result, WhatIsNotThereCannotBeTaken) {
  const Result<int> bad(Error{"no", "", "", ""});
  const Result<int> good(5);
  EXPECT_DEATH(static_cast<void>(*bad), "assertion failed");
  EXPECT_DEATH(static_cast<void>(good.error()), "assertion failed");
  EXPECT_DEATH(static_cast<void>(Result<void>().error()), "assertion failed");
}

}  // namespace
}  // namespace tactum
