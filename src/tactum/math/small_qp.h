#pragma once
/// The point nearest to the origin in a polyhedron, in a few unknowns:
///
///     least |z|^2 / 2   with   g_i . z >= b_i           z = sum_i u_i g_i,   u_i >= 0,   u_i = 0 where kept
///                                                                                        with room to spare
///
/// Every strictly convex quadratic program is of this form in the coordinates in which its metric is the
/// identity. By the dual active set method of [Goldfarb and Idnani 1983], whose start, the origin, costs
/// nothing: pick a row that is broken, walk until it is kept or a row that holds the point would have to
/// pull, let that one go, go on. The rows that hold are kept as an orthogonal and a triangular factor, so
/// that taking a row in or letting it go costs the square of the number of unknowns.
///
/// Rows are scanned for the most broken one, so a thousand of them cost a microsecond or so a scan; a row
/// that held in the last problem is looked at first (`first`), and when those are the right ones a single
/// scan confirms it. Rows that depend on each other, up to rounding, are no difficulty: one of them holds.
/// Nothing is allocated, every loop is bounded, the same rows give the same bits.

#include <array>
#include <span>

#include "tactum/base/static_vector.h"

namespace tactum {

inline constexpr std::size_t kMostUnknowns = 24;  ///< four free bodies

struct QpProblem {
  std::size_t unknowns = 0;         ///< at most kMostUnknowns
  std::span<const double> normals;  ///< g_i, `unknowns` numbers each, row after row
  std::span<const double> offsets;  ///< b_i
  double slack = 0.0;               ///< a row is kept when it is missed by no more than this
};

/// A row that holds the point, and how hard.
struct QpActive {
  int row = -1;
  double multiplier = 0.0;  ///< u_i >= 0
};

enum class QpStatus {
  kSolved,
  kInfeasible,  ///< no point keeps all rows; z is the nearest that keeps those that hold, and misses others
  kBounded,     ///< out of iterations; the same
};

struct QpAnswer {
  QpStatus status = QpStatus::kSolved;
  int iterations = 0;  ///< rows taken in or let go
  std::array<double, kMostUnknowns> z{};
  StaticVector<QpActive, kMostUnknowns> active;  ///< in the order in which they were taken in
};

/// `first`: rows to look at before all others, as a rule those that held in a similar problem.
void solve_small_qp(const QpProblem& problem, std::span<const int> first, int max_iterations,
                    QpAnswer& answer) noexcept;

}  // namespace tactum
