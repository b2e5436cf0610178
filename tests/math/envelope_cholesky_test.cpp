#include "tactum/math/envelope_cholesky.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Dense>
#include <vector>

#include "tactum/base/random.h"

namespace tactum {
namespace {

/// Matrices with random envelopes, as Eigen solves them whole.
TEST(EnvelopeCholesky, SolvesAsADenseFactorDoes) {
  Random random(7);
  for (int trial = 0; trial < 200; ++trial) {
    const auto n = static_cast<Eigen::Index>(1 + random.index(40));
    std::vector<std::uint32_t> first;
    for (Eigen::Index i = 0; i < n; ++i)
      first.push_back(static_cast<std::uint32_t>(random.index(static_cast<int>(i) + 1)));
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = first[static_cast<std::size_t>(i)]; j < i; ++j)
        A(i, j) = A(j, i) = random.uniform(-1.0, 1.0);
      A(i, i) = 41.0;
    }
    EnvelopeCholesky factor(40, 1000);
    ASSERT_TRUE(factor.begin(first));
    factor.reset(40.0);
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = first[static_cast<std::size_t>(i)]; j < i; ++j)
        factor.entry(static_cast<std::size_t>(i), static_cast<std::size_t>(j)) += A(i, j);
      factor.entry(static_cast<std::size_t>(i), static_cast<std::size_t>(i)) += 1.0;
    }
    ASSERT_TRUE(factor.factor());
    Eigen::VectorXd b(n);
    for (double& value : b) value = random.uniform(-1.0, 1.0);
    std::vector<double> x(b.begin(), b.end());
    factor.solve(x);
    const Eigen::VectorXd right = A.llt().solve(b);
    for (Eigen::Index i = 0; i < n; ++i) EXPECT_NEAR(x[static_cast<std::size_t>(i)], right[i], 1e-14);
  }
}

TEST(EnvelopeCholesky, RefusesWhatHasNoRoomOrNoFactor) {
  EnvelopeCholesky factor(3, 5);
  EXPECT_FALSE(factor.begin(std::vector<std::uint32_t>{0, 0, 0}));     // six entries
  EXPECT_FALSE(factor.begin(std::vector<std::uint32_t>{0, 1, 2, 3}));  // four unknowns
  ASSERT_TRUE(factor.begin(std::vector<std::uint32_t>{0, 0, 1}));
  factor.reset(1.0);
  factor.entry(1, 0) = 2.0;
  EXPECT_FALSE(factor.factor());
}

}  // namespace
}  // namespace tactum
