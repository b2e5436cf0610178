#pragma once
/// The point nearest to the origin in a polyhedron, in a few unknowns:
///
///     least |z|^2 / 2   with   g_i . z >= b_i           z = sum_i u_i g_i,   u_i >= 0,   u_i = 0 where kept
///                                                                                        with room to spare
///
/// Every strictly convex quadratic program is of this form in the coordinates in which its metric is the
/// identity. By the dual active set method of [Goldfarb and Idnani 1983]: pick a row that is broken, walk
/// until it is kept or a row that holds the point would have to pull, let that one go, go on. The rows that
/// hold are kept as an orthogonal and a triangular factor, so that taking a row in or letting it go costs the
/// square of the number of unknowns.
///
/// The walk may begin at any set of rows that all push, when the point is the nearest that keeps these: with
/// none it is the origin. The rows that held in the last problem (`first`) are made such a set at once, those
/// that would pull let go; when they are the right ones a single scan of all rows confirms it. When only
/// offsets have changed, the factor still stands (solve_on). A scan of all rows looks for the most broken one
/// before each is taken in; to take in all that one scan finds broken costs a round peg in its hole far more
/// iterations than it saves scans. Rows that depend on each other, up to rounding, are no difficulty: one of
/// them holds. Nothing is allocated, every loop is bounded, the same rows give the same bits.

#include <array>
#include <cstdint>
#include <span>

#include "tactum/base/static_vector.h"

namespace tactum {

inline constexpr std::size_t kMostUnknowns = 36;  ///< six free bodies

/// g_i and b_i. A row pushes on two bodies at most: its normal is zero outside of two runs of unknowns.
struct QpRow {
  static constexpr std::size_t kLongestRun = 6;
  struct Run {
    std::uint32_t first = 0, count = 0;
    std::array<double, kLongestRun> g{};
  };
  Run runs[2];
  double offset = 0.0;
};

struct QpProblem {
  std::size_t unknowns = 0;     ///< at most kMostUnknowns
  std::span<const QpRow> rows;  ///< any number
  double slack = 0.0;           ///< a row is kept when it is missed by no more than this
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
  int iterations = 0;  ///< rows taken in or let go, but for those it began with
  std::array<double, kMostUnknowns> z{};
  StaticVector<QpActive, kMostUnknowns> active;  ///< in the order in which they were taken in
};

class SmallQp {
 public:
  /// Begins with the rows `first`, as a rule those that held in a similar problem; solves nothing yet.
  void begin(const QpProblem& problem, std::span<const int> first) noexcept;
  /// Goes on from there, or from the last answer. Since then offsets may have changed and rows may have come
  /// or gone at the end; the normals of the others are the same.
  const QpAnswer& solve_on(const QpProblem& problem, int max_iterations) noexcept;
  const QpAnswer& solve(const QpProblem& problem, std::span<const int> first, int max_iterations) noexcept {
    begin(problem, first);
    return solve_on(problem, max_iterations);
  }
  /// Of the last problem.
  const QpAnswer& answer() const noexcept { return answer_; }

 private:
  std::size_t count() const noexcept { return answer_.active.size(); }
  double& triangular(std::size_t row, std::size_t column) noexcept { return R_[row * n_ + column]; }
  double* orthogonal(std::size_t column) noexcept { return Q_.data() + column * n_; }

  void begin_at_active() noexcept;
  bool most_broken(std::size_t& worst) const noexcept;
  double missing(const QpRow& row) const noexcept;
  QpStatus take(std::size_t index, int max_iterations) noexcept;
  bool set_direction(const QpRow& row, double least_share) noexcept;
  void set_push() noexcept;
  double longest_step(std::size_t& blocking) const noexcept;
  void append(std::size_t row, double multiplier) noexcept;
  void release(std::size_t leaving) noexcept;

  QpProblem problem_;
  QpAnswer answer_;
  // The normals of the rows that hold are N = Q1 R, with Q = [Q1 Q2] orthogonal and R upper triangular.
  std::size_t n_ = 0;
  std::array<double, kMostUnknowns * kMostUnknowns> Q_{};  // column by column
  std::array<double, kMostUnknowns * kMostUnknowns> R_{};  // row by row
  std::array<double, kMostUnknowns> d_{}, push_{}, work_{};
  double free_sq_ = 0.0;
};

}  // namespace tactum
