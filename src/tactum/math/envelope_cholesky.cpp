#include "tactum/math/envelope_cholesky.h"

#include <algorithm>
#include <cmath>

#include "tactum/math/lane_sum.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

}  // namespace

EnvelopeCholesky::EnvelopeCholesky(std::size_t most_unknowns, std::size_t most_entries) {
  first_.reserve(most_unknowns);
  starts_.reserve(most_unknowns);
  inverse_.reserve(most_unknowns);
  entries_.reserve(most_entries);
}

bool EnvelopeCholesky::begin(std::span<const std::uint32_t> first) noexcept {
  if (first.size() > first_.capacity()) return false;
  first_.assign(first.begin(), first.end());
  starts_.clear();
  multiplications_ = 0.0;
  Index entries = 0;
  for (Index i = 0; i < first.size(); ++i) {
    starts_.push_back(entries - first[i]);  // may wrap around; the sum with a column does not
    const Index length = i + 1 - first[i];
    entries += length;
    multiplications_ += 0.5 * static_cast<double>(length) * static_cast<double>(length);
  }
  if (entries > entries_.capacity()) return false;
  entries_.resize(entries);
  inverse_.resize(first.size());
  return true;
}

void EnvelopeCholesky::reset(double diagonal) noexcept {
  std::fill(entries_.begin(), entries_.end(), 0.0);
  for (Index i = 0; i < first_.size(); ++i) entry(i, i) = diagonal;
}

bool EnvelopeCholesky::factor() noexcept {
  for (Index i = 0; i < first_.size(); ++i) {
    const Index from = first_[i];
    double* const row = &entries_[starts_[i] + from];
    double diagonal = row[i - from];
    for (Index j = from; j < i; ++j) {
      const Index common = std::max<Index>(from, first_[j]);
      const double* const other = &entries_[starts_[j] + common];
      double& value = row[j - from];
      value = (value - lane_sum(row + (common - from), other, j - common)) * inverse_[j];
      diagonal -= value * value;
    }
    if (!(diagonal > 0.0)) return false;
    inverse_[i] = 1.0 / std::sqrt(diagonal);
  }
  return true;
}

void EnvelopeCholesky::solve(std::span<double> x) const noexcept {
  for (Index i = 0; i < first_.size(); ++i) {
    const Index from = first_[i];
    x[i] = (x[i] - lane_sum(&entries_[starts_[i] + from], &x[from], i - from)) * inverse_[i];
  }
  for (Index i = first_.size(); i-- > 0;) {
    const Index from = first_[i];
    const double* const row = &entries_[starts_[i] + from];
    x[i] *= inverse_[i];
    for (Index j = from; j < i; ++j) x[j] -= row[j - from] * x[i];
  }
}

}  // namespace tactum::inline v0_1
