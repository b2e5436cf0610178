#include "tactum/base/reserved_vector.h"

#include <gtest/gtest.h>

#include <utility>

namespace tactum {
namespace {

TEST(ReservedVector, ACopyHoldsTheSameAndHasAsMuchRoom) {
  ReservedVector<int> original;
  original.reserve(100);
  original.push_back(7);
  const ReservedVector<int> copy(original);
  ReservedVector<int> assigned;
  assigned = original;
  EXPECT_EQ(copy, original);
  EXPECT_EQ(assigned, original);
  EXPECT_GE(copy.capacity(), 100u);
  EXPECT_GE(assigned.capacity(), 100u);
}

TEST(ReservedVector, AMoveTakesTheRoomAlong) {
  ReservedVector<int> original;
  original.reserve(100);
  original.assign(3, 5);
  const int* const data = original.data();
  const ReservedVector<int> moved(std::move(original));
  EXPECT_EQ(moved.data(), data);
  EXPECT_GE(moved.capacity(), 100u);
}

}  // namespace
}  // namespace tactum
