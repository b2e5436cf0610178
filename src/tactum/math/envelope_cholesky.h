#pragma once
/// The Cholesky factor of a sparse symmetric positive definite matrix, stored by rows from the first entry
/// of each that is not zero [Jennings 1966]. Nothing outside of this envelope ever becomes other than zero,
/// so an order of the unknowns that keeps neighbours together keeps memory and work low: for a pile of bodies
/// that touch only their neighbours both grow with the number of bodies.
///
/// Sums are taken in an order that does not depend on the processor, so that the answers are the same bits.
/// Nothing allocates after the constructor.

#include <cstddef>
#include <cstdint>
#include <span>

#include "tactum/base/reserved_vector.h"

namespace tactum::inline v0_1 {

class EnvelopeCholesky {
 public:
  /// Room for so many unknowns and for so many entries of all rows together.
  EnvelopeCholesky(std::size_t most_unknowns, std::size_t most_entries);

  /// Takes a matrix of zeros whose row i has entries from first[i] <= i to i. False when there is no room for
  /// it; then nothing else may be called.
  bool begin(std::span<const std::uint32_t> first) noexcept;
  /// How many multiplications factor() takes, by the envelope of begin().
  double multiplications() const noexcept { return multiplications_; }

  /// Sets every entry to zero, and those of the diagonal to `diagonal`.
  void reset(double diagonal) noexcept;
  /// The entry of row i and column j <= i, which is inside of the envelope.
  double& entry(std::size_t i, std::size_t j) noexcept { return entries_[starts_[i] + j]; }

  /// The first column of each row, where each row stands among the entries, and the entries.
  std::span<const std::uint32_t> first() const noexcept { return first_; }
  std::span<const std::size_t> starts() const noexcept { return starts_; }
  std::span<const double> entries() const noexcept { return entries_; }

  /// Replaces the matrix by its factor. False when the matrix is not positive definite.
  bool factor() noexcept;
  /// Replaces x by the solution of  matrix * solution = x.
  void solve(std::span<double> x) const noexcept;

 private:
  ReservedVector<std::uint32_t> first_;
  ReservedVector<std::size_t> starts_;  // entry (i, j) is number starts_[i] + j
  ReservedVector<double> entries_;
  ReservedVector<double> inverse_;  // of the factor's diagonal
  double multiplications_ = 0.0;
};

}  // namespace tactum::inline v0_1
