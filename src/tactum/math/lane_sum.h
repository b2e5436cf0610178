#pragma once
/// The scalar product of two runs of numbers, as the factors of sparse matrices take it.

#include <cstddef>

namespace tactum::inline v0_1 {

/// The scalar product of n numbers, by four sums that a compiler may keep in lanes.
inline double lane_sum(const double* x, const double* y, std::size_t n) noexcept {
  double s0 = 0.0;
  double s1 = 0.0;
  double s2 = 0.0;
  double s3 = 0.0;
  std::size_t i = 0;
  for (; i + 4 <= n; i += 4) {
    s0 += x[i] * y[i];
    s1 += x[i + 1] * y[i + 1];
    s2 += x[i + 2] * y[i + 2];
    s3 += x[i + 3] * y[i + 3];
  }
  double sum = (s0 + s2) + (s1 + s3);
  for (; i < n; ++i) sum += x[i] * y[i];
  return sum;
}

}  // namespace tactum::inline v0_1
