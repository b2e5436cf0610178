/// The table of docs/mechanics.md: our errors stay within the bounds that its cases state.

#include "bench/mechanics.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tactum::bench {
namespace {

TEST(Mechanics, BothResponsesStayWithinTheirBounds) {
  for (const MechanicsCase& at : mechanics_cases()) {
    SCOPED_TRACE(at.name);
    const double constraint = seen_by_ours(at, ResponseModel::kConstraint);
    EXPECT_LE(at.error(constraint), at.bounds.constraint) << constraint << ", right " << at.right;
    if (!std::isfinite(at.bounds.penalty)) continue;
    const double penalty = seen_by_ours(at, ResponseModel::kPenalty);
    EXPECT_LE(at.error(penalty), at.bounds.penalty) << penalty << ", right " << at.right;
  }
}

TEST(Mechanics, AnErrorIsRelativeOrThatOfZero) {
  EXPECT_DOUBLE_EQ((MechanicsCase{.name = "", .law = "", .unit = "m", .right = 2.0, .bounds = {}}.error(3.0)),
                   0.5);
  EXPECT_DOUBLE_EQ(
      (MechanicsCase{.name = "", .law = "", .unit = "m", .right = 0.0, .bounds = {}}.error(-3.0)), 3.0);
}

}  // namespace
}  // namespace tactum::bench
