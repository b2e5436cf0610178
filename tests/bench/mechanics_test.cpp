/// The table of docs/mechanics.md: our errors stay within the bounds that its cases state.

#include "bench/mechanics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <span>
#include "support/effort.h"

namespace tactum::bench::mechanics_test {
namespace {

TEST(Mechanics, BothResponsesStayWithinTheirBounds) {
  const std::span<const MechanicsCase> cases = mechanics_cases();
  for (std::size_t i = 0; i < cases.size(); i += testing::effort<std::size_t>(1, 4)) {
    const MechanicsCase& at = cases[i];
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
}  // namespace tactum::bench::mechanics_test
