#include "tactum/math/envelope_lu.h"

#include <algorithm>

#include "tactum/math/lane_sum.h"

namespace tactum::inline v0_1 {

EnvelopeLu::EnvelopeLu(std::size_t most_unknowns, std::size_t most_entries) {
  first_.reserve(most_unknowns);
  starts_.reserve(most_unknowns);
  inverse_.reserve(most_unknowns);
  lower_.reserve(most_entries);
  upper_.reserve(most_entries);
}

void EnvelopeLu::assign(const EnvelopeCholesky& matrix) noexcept {
  first_.assign(matrix.first().begin(), matrix.first().end());
  starts_.assign(matrix.starts().begin(), matrix.starts().end());
  lower_.assign(matrix.entries().begin(), matrix.entries().end());
  upper_.assign(matrix.entries().begin(), matrix.entries().end());
  inverse_.resize(first_.size());
}

bool EnvelopeLu::factor() noexcept {
  for (std::size_t i = 0; i < first_.size(); ++i) {
    const std::size_t from = first_[i];
    double* const row = &lower_[starts_[i] + from];
    double* const column = &upper_[starts_[i] + from];
    double pivot = row[i - from];
    for (std::size_t j = from; j < i; ++j) {
      const std::size_t common = std::max<std::size_t>(from, first_[j]);
      const std::size_t length = j - common;
      double& left = row[j - from];
      double& above = column[j - from];
      left = (left - lane_sum(row + (common - from), &upper_[starts_[j] + common], length)) * inverse_[j];
      above -= lane_sum(column + (common - from), &lower_[starts_[j] + common], length);
      pivot -= left * above;
    }
    if (!(pivot > 0.0)) return false;
    inverse_[i] = 1.0 / pivot;
  }
  return true;
}

void EnvelopeLu::solve(std::span<double> x) const noexcept {
  for (std::size_t i = 0; i < first_.size(); ++i) {
    const std::size_t from = first_[i];
    x[i] -= lane_sum(&lower_[starts_[i] + from], &x[from], i - from);
  }
  for (std::size_t i = first_.size(); i-- > 0;) {
    const std::size_t from = first_[i];
    const double* const column = &upper_[starts_[i] + from];
    x[i] *= inverse_[i];
    for (std::size_t j = from; j < i; ++j) x[j] -= column[j - from] * x[i];
  }
}

}  // namespace tactum::inline v0_1
