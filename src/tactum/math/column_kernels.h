#pragma once
/// The inner loops of small_qp.h over columns of numbers: two lanes at once, which every processor has, or
/// four where it has AVX2. Each sum is taken in the same order either way, so the answers are the same bits.
///
/// Columns lie one behind the other, kColumn numbers each; lengths `n` are multiples of eight.

#include <cstddef>

#include "tactum/base/cpu_dispatch.h"

namespace tactum::inline v0_1 {

inline constexpr std::size_t kMostUnknowns = 36;  ///< six free bodies

namespace columns {

/// Room for a run of rows that begins at the last unknown, in whole lanes.
inline constexpr std::size_t kColumn = kMostUnknowns + 8;

struct Kernels {
  /// to += sign * sum of shares[k] * column k, of `count` columns.
  void (*combine)(const double* columns, std::size_t count, const double* shares, double sign, std::size_t n,
                  double* to);
  /// shares[k] = column k . x
  void (*dots)(const double* columns, std::size_t count, const double* x, std::size_t n, double* shares);
  double (*dot)(const double* x, const double* y, std::size_t n);
  /// x = R^-1 rest, R upper triangular of `count` columns, `reciprocal` of its diagonal. Rest is overwritten,
  /// and so is the memory behind its `count` numbers, to the next multiple of eight.
  void (*solve_upper)(const double* columns, const double* reciprocal, std::size_t count, double* rest,
                      double* x);
  /// (one, other) -> (cosine one + sine other, cosine other - sine one)
  void (*turn)(double cosine, double sine, std::size_t n, double* one, double* other);
};

/// Two lanes at a time on any processor, four with AVX2.
CpuBuilds<Kernels> builds() noexcept;

}  // namespace columns
}  // namespace tactum::inline v0_1
