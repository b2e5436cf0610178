#pragma once
/// Quantiles of measured values.

#include <algorithm>
#include <cmath>
#include <vector>

namespace tactum::bench {

/// The smallest of the values, in ascending order, that at least a fraction `q` of them do not exceed; 0 of
/// none.
inline double quantile(const std::vector<double>& ascending, double q) {
  if (ascending.empty()) return 0.0;
  const auto rank = static_cast<std::size_t>(std::ceil(q * static_cast<double>(ascending.size())));
  return ascending[std::min(ascending.size(), std::max<std::size_t>(rank, 1)) - 1];
}

}  // namespace tactum::bench
