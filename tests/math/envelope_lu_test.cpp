#include "tactum/math/envelope_lu.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <Eigen/LU>
#include <vector>

#include "tactum/base/random.h"

namespace tactum {
namespace {

/// Matrices with random envelopes and different values on either side, as Eigen solves them whole.
TEST(EnvelopeLu, SolvesAsADenseFactorDoes) {
  Random random(11);
  for (int trial = 0; trial < 200; ++trial) {
    const auto n = static_cast<Eigen::Index>(1 + random.index(40));
    std::vector<std::uint32_t> first;
    for (Eigen::Index i = 0; i < n; ++i)
      first.push_back(static_cast<std::uint32_t>(random.index(static_cast<int>(i) + 1)));
    EnvelopeCholesky symmetric(40, 1000);
    ASSERT_TRUE(symmetric.begin(first));
    symmetric.reset(40.0);
    Eigen::MatrixXd A = 40.0 * Eigen::MatrixXd::Identity(n, n);
    const auto at = [](Eigen::Index i) { return static_cast<std::size_t>(i); };
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = first[at(i)]; j < i; ++j)
        symmetric.entry(at(i), at(j)) = A(i, j) = A(j, i) = random.uniform(-1.0, 1.0);
    EnvelopeLu factor(40, 1000);
    factor.assign(symmetric);
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = first[at(i)]; j <= i; ++j) {
        const double below = random.uniform(-1.0, 1.0);
        factor.add(at(i), at(j), below);
        A(i, j) += below;
        if (i == j) continue;
        const double above = random.uniform(-1.0, 1.0);
        factor.add(at(j), at(i), above);
        A(j, i) += above;
      }
    ASSERT_TRUE(factor.factor());
    Eigen::VectorXd b(n);
    for (double& value : b) value = random.uniform(-1.0, 1.0);
    std::vector<double> x(b.begin(), b.end());
    factor.solve(x);
    const Eigen::VectorXd right = A.partialPivLu().solve(b);
    for (Eigen::Index i = 0; i < n; ++i) EXPECT_NEAR(x[at(i)], right[i], 1e-14);
  }
}

TEST(EnvelopeLu, RefusesAPivotThatIsNotPositive) {
  EnvelopeCholesky symmetric(2, 3);
  ASSERT_TRUE(symmetric.begin(std::vector<std::uint32_t>{0, 0}));
  symmetric.reset(1.0);
  for (const double above : {0.99, 1.01}) {
    EnvelopeLu factor(2, 3);
    factor.assign(symmetric);
    factor.add(0, 1, above);
    factor.add(1, 0, 1.0);  // the second pivot is 1 - above
    EXPECT_EQ(factor.factor(), above < 1.0);
  }
}

}  // namespace
}  // namespace tactum
