#pragma once
/// The factors L U of a sparse matrix whose places, not its values, are symmetric: row i has entries from
/// first[i] on, and so has column i. It takes twice the memory and the work of EnvelopeCholesky.
///
/// Rows are not exchanged, which would spoil the envelope: a matrix that is far from definite has no factors
/// here. Sums are taken in an order that does not depend on the processor. Nothing allocates after the
/// constructor.

#include <cstddef>
#include <cstdint>
#include <span>

#include "tactum/base/reserved_vector.h"
#include "tactum/math/envelope_cholesky.h"

namespace tactum::inline v0_1 {

class EnvelopeLu {
 public:
  /// Room for so many unknowns and for so many entries on either side of the diagonal.
  EnvelopeLu(std::size_t most_unknowns, std::size_t most_entries);

  /// Takes the values of a symmetric matrix that is not factored yet.
  void assign(const EnvelopeCholesky& matrix) noexcept;
  /// Adds to the entry of row i and column j, one of which is within the envelope of the other.
  void add(std::size_t i, std::size_t j, double value) noexcept {
    if (j <= i) lower_[starts_[i] + j] += value;
    if (i <= j) upper_[starts_[j] + i] += value;
  }

  /// Replaces the matrix by its factors. False when a pivot is not positive.
  bool factor() noexcept;
  /// Replaces x by the solution of  matrix * solution = x.
  void solve(std::span<double> x) const noexcept;

 private:
  ReservedVector<std::uint32_t> first_;
  ReservedVector<std::size_t> starts_;  // as in EnvelopeCholesky
  /// By rows and by columns, each with the diagonal, which both hold until it is factored.
  ReservedVector<double> lower_, upper_;
  ReservedVector<double> inverse_;  // of the pivots
};

}  // namespace tactum::inline v0_1
