#include "tactum/math/column_kernels.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "tactum/base/random.h"

namespace tactum {
namespace {

using columns::kColumn;
using columns::Kernels;

constexpr std::size_t kCount = 13;

std::vector<double> random_numbers(Random& random, std::size_t n) {
  std::vector<double> numbers(n);
  for (double& x : numbers) x = random.uniform(-1.0, 1.0);
  return numbers;
}

/// The results of all kernels from the same numbers, one behind the other.
std::vector<double> all_of(const Kernels& kernels, std::uint64_t seed, std::size_t n) {
  Random random(seed);
  std::vector<double> columns = random_numbers(random, kCount * kColumn);
  const std::vector<double> shares = random_numbers(random, kColumn);
  std::vector<double> x = random_numbers(random, kColumn);
  std::vector<double> made;
  std::vector<double> to = x;
  kernels.combine(columns.data(), kCount, shares.data(), -1.0, n, to.data());
  made.insert(made.end(), to.begin(), to.end());
  std::vector<double> dots(kCount);
  kernels.dots(columns.data(), kCount, x.data(), n, dots.data());
  made.insert(made.end(), dots.begin(), dots.end());
  made.push_back(kernels.dot(columns.data(), x.data(), n));
  std::vector<double> solved(kCount);
  kernels.solve_upper(columns.data(), shares.data(), kCount, x.data(), solved.data());
  made.insert(made.end(), solved.begin(), solved.end());
  kernels.turn(0.8, 0.6, n, columns.data(), columns.data() + kColumn);
  made.insert(made.end(), columns.begin(), columns.begin() + 2 * kColumn);
  return made;
}

TEST(ColumnKernels, TwoLanesAndFourMakeTheSameBits) {
  const Kernels* wide = columns::builds().usable_wide();
  if (!wide) GTEST_SKIP() << "this processor has no AVX2: nothing to compare";
  for (std::size_t n = 8; n <= 40; n += 8)
    EXPECT_EQ(all_of(*columns::builds().narrow, n, n), all_of(*wide, n, n)) << n << " numbers";
}

TEST(ColumnKernels, DoWhatTheySay) {
  constexpr std::size_t n = 16;
  const Kernels& kernels = columns::builds().best();
  Random random(5);
  const std::vector<double> columns = random_numbers(random, kCount * kColumn);
  const std::vector<double> shares = random_numbers(random, kCount);
  std::vector<double> to(n, 1.0);
  kernels.combine(columns.data(), kCount, shares.data(), -1.0, n, to.data());
  for (std::size_t i = 0; i < n; ++i) {
    double expected = 1.0;
    for (std::size_t k = 0; k < kCount; ++k) expected -= shares[k] * columns[k * kColumn + i];
    EXPECT_NEAR(to[i], expected, 1e-14);
  }
  std::vector<double> reciprocal(kCount), rest(kColumn, 0.0), x(kCount);
  for (std::size_t k = 0; k < kCount; ++k) reciprocal[k] = 1.0 / columns[k * kColumn + k];
  for (std::size_t i = 0; i < kCount; ++i)
    for (std::size_t k = i; k < kCount; ++k) rest[i] += columns[k * kColumn + i] * shares[k];
  kernels.solve_upper(columns.data(), reciprocal.data(), kCount, rest.data(), x.data());
  for (std::size_t k = 0; k < kCount; ++k) EXPECT_NEAR(x[k], shares[k], 1e-6) << "row " << k;
  std::array<double, 8> one{3.0}, other{4.0};
  kernels.turn(0.6, 0.8, 8, one.data(), other.data());
  EXPECT_DOUBLE_EQ(one[0], 5.0);
  EXPECT_NEAR(other[0], 0.0, 1e-15);
}

}  // namespace
}  // namespace tactum
