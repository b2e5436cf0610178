#pragma once
/// The point nearest to the origin in a polyhedron, in a few unknowns:
///
///     least |z|^2 / 2   with   g_i . z >= b_i           z = sum_i u_i g_i,   u_i >= 0,   u_i = 0 where kept
///                                                                                        with room to spare
///
/// Every strictly convex quadratic program is of this form in the coordinates in which its metric is the
/// identity. By the dual active set method of [Goldfarb and Idnani 1983]: pick a row that is broken, walk
/// until it is kept or a row that holds the point would have to pull, let that one go, go on. The rows that
/// hold are kept as an orthogonal and a triangular factor with as many columns as rows hold, made by
/// Gram-Schmidt, twice where once would leave the columns less square than they should be [Giraud
/// 2005]: so taking a row in or letting it go costs the unknowns times the rows that hold.
///
/// The walk may begin at any set of rows that all push, when the point is the nearest that keeps these: with
/// none it is the origin. The rows that held in the last problem (`first`) are made such a set at once, those
/// that would pull let go; when they are the right ones a single scan of all rows confirms it. When only
/// offsets have changed, the factor still stands (solve_on). The most broken row is taken in first; of
/// several bodies, of those that the last scan of all rows found broken, looked at again each time, until
/// none of them is broken any more. (To take them in without looking again costs a round peg in its hole far
/// more iterations than it saves scans.) Rows that depend on each other, up to rounding, are no difficulty:
/// one of them holds. Nothing is allocated, every loop is bounded, the same rows give the same bits.

#include <array>
#include <cstdint>
#include <span>

#include "tactum/base/static_vector.h"

namespace tactum {

inline constexpr std::size_t kMostUnknowns = 36;  ///< six free bodies

/// g_i and b_i. A row pushes on two bodies at most: its normal is zero outside of two runs of unknowns, and g
/// from `count` on.
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
  int iterations = 0;                            ///< rows taken in or let go, but for those it began with
  std::array<double, kMostUnknowns + 8> z{};     ///< zero beyond the unknowns
  StaticVector<QpActive, kMostUnknowns> active;  ///< in the order in which they were taken in
};

class SmallQp {
 public:
  /// Begins with the rows `first`, as a rule those that held in a similar problem; solves nothing yet.
  void begin(const QpProblem& problem, std::span<const int> first) noexcept;
  /// Goes on from there, or from the last answer. Since then offsets may have changed and rows may have come
  /// or gone at the end; the normals of the others are the same.
  const QpAnswer& solve_on(const QpProblem& problem, int max_iterations) noexcept;
  /// How far the last answer is from keeping a row; negative: with so much to spare.
  double missing(const QpRow& row) const noexcept;
  /// Of the last problem.
  const QpAnswer& answer() const noexcept { return answer_; }

 private:
  // A column has room for a run that begins at the last unknown, in whole lanes.
  static constexpr std::size_t kColumn = kMostUnknowns + 8;
  static constexpr std::size_t kMostBroken = 64;  // rows remembered of a scan
  using Column = std::array<double, kColumn>;

  std::size_t count() const noexcept { return answer_.active.size(); }

  void begin_at_active() noexcept;
  bool most_broken(std::size_t& worst) noexcept;
  QpStatus take(std::size_t index, int max_iterations) noexcept;
  bool set_direction(const QpRow& row, double least_share) noexcept;
  void take_off(const Column& shares) noexcept;
  void set_push() noexcept;
  double longest_step(std::size_t& blocking) const noexcept;
  void append(std::size_t row, double multiplier) noexcept;
  void release(std::size_t leaving) noexcept;

  QpProblem problem_;
  QpAnswer answer_;
  StaticVector<std::uint32_t, kMostBroken> broken_;  // in the last scan of all rows
  // The normals of the rows that hold are N = Q R, with Q^T Q the identity and R upper triangular.
  std::array<Column, kMostUnknowns> Q_{}, R_{};  // columns
  Column diagonal_{};                            // of R, each entry's reciprocal
  Column along_{};                               // Q^T g of the row that is looked at
  Column free_{};                                // what is left of g beside the rows that hold
  Column push_{};                                // R^-1 along
  Column work_{};
  double free_sq_ = 0.0;
  // How far from square the columns of Q may be, at most, and what is free to them.
  double off_square_ = 0.0, free_off_square_ = 0.0;
};

}  // namespace tactum
