#pragma once
/// The point nearest to the origin in a polyhedron, in a few unknowns:
///
///     least |z|^2 / 2   with   g_i . z >= b_i           z = sum_i u_i g_i,   u_i >= 0,   u_i = 0 where kept
///                                                                                        with room to spare
///
/// Every strictly convex quadratic program is of this form in the coordinates in which its metric is the
/// identity. The dual active set method of [Goldfarb and Idnani 1983] solves it: pick a row that is broken,
/// move until it is kept or an active row would have to pull, drop that one, go on. The active rows are
/// stored as an orthogonal and a triangular factor with as many columns as there are active rows, made by
/// Gram-Schmidt, twice where once would leave the columns less orthogonal than they should be [Giraud 2005]:
/// so adding a row or dropping it costs the unknowns times the active rows.
///
/// The method may begin at any set of rows that all push, when the point is the nearest that keeps these:
/// with none it is the origin. The rows that were active in the last problem (`first`) are made such a set at
/// once, those that would pull are dropped; when they are the right ones a single scan of all rows confirms
/// it. When only offsets have changed, the factor still holds (solve_on). The most broken row is added first;
/// for several bodies, of those that the last scan of all rows found broken, each evaluated again every time,
/// until none of them is broken any more. (Without evaluating them again a round peg in its hole takes far
/// more iterations than it saves scans.) Rows that depend on each other, up to rounding, are no difficulty:
/// one of them is active. Nothing is allocated, every loop is bounded, the same rows give the same bits.

#include <array>
#include <cstdint>
#include <span>

#include "tactum/base/static_vector.h"
#include "tactum/math/column_kernels.h"

namespace tactum::inline v0_1 {

/// g_i and b_i. A row pushes on two bodies at most: its normal is zero outside of two runs of unknowns, and
/// so are the entries of g from `count` on.
struct QpRow {
  static constexpr std::size_t kLongestRun = 6;
  struct Run {
    std::uint32_t first = 0, count = 0;
    std::array<double, kLongestRun> g{};
  };
  Run runs[2];
  double offset = 0.0;
};

/// g . z. The eight numbers of z behind the last unknown are read too, and multiplied by zeros.
double dot(const QpRow& row, const double* z) noexcept;

/// Rows that are made of four, the edges of a cone: off - slope (cos along + sin across) at equal angles,
/// then off - twist about and off + twist about. They are evaluated together, by four sums.
struct QpCone {
  static constexpr std::size_t kAround = 12, kEdges = kAround + 2;
  struct Direction {
    double cosine, sine;
  };
  /// For edge k < kAround.
  static Direction direction(std::size_t k) noexcept;
  QpRow edge(std::size_t k) const noexcept;
  double offset(std::size_t k) const noexcept;

  QpRow off, along, across, about;
  double slope = 0.0, twist = 0.0;
  std::array<double, kEdges> more{};  ///< offset of each edge beside the offsets of the four

 private:
  struct Mixture;
  Mixture mixture(std::size_t k) const noexcept;
};

/// Rows are numbered: first `rows`, then the edges of each cone.
struct QpProblem {
  std::size_t unknowns = 0;       ///< at most kMostUnknowns
  std::span<const QpRow> rows;    ///< any number
  std::span<const QpCone> cones;  ///< any number
  std::size_t equalities = 0;     ///< the first so many rows are equations: always active
  double tolerance = 0.0;         ///< a row is kept when it is missed by no more than this

  std::size_t size() const noexcept { return rows.size() + cones.size() * QpCone::kEdges; }
  QpRow row(std::size_t number) const noexcept;
  double offset(std::size_t number) const noexcept;
};

/// An active row, and its multiplier.
struct QpActive {
  int row = -1;
  double multiplier = 0.0;  ///< u_i >= 0; of an equation of either sign
};

enum class QpStatus {
  kSolved,
  kInfeasible,  ///< no point keeps all rows; z is the nearest that keeps the active ones, and misses others
  kBounded,     ///< out of iterations; the same
};

struct QpAnswer {
  QpStatus status = QpStatus::kSolved;
  int iterations = 0;                            ///< rows added or dropped, but for those it began with
  std::array<double, columns::kColumn> z{};      ///< zero beyond the unknowns
  StaticVector<QpActive, kMostUnknowns> active;  ///< in the order in which they were added
};

class SmallQp {
 public:
  /// Begins with the rows `first`, as a rule those that were active in a similar problem; solves nothing yet.
  void begin(const QpProblem& problem, std::span<const int> first) noexcept;
  /// Solves from there, or from the last answer. Since then offsets may have changed and rows may have been
  /// added or removed at the end; the normals of the others are the same.
  const QpAnswer& solve_on(const QpProblem& problem, int max_iterations) noexcept;
  /// By how much the last answer misses a row; negative: the margin by which it keeps the row.
  double missing(const QpRow& row) const noexcept;
  /// Of the last problem.
  const QpAnswer& answer() const noexcept { return answer_; }

 private:
  static constexpr std::size_t kMostBroken = 64;  // stored of a scan, of either kind
  using Column = std::array<double, columns::kColumn>;

  std::size_t count() const noexcept { return answer_.active.size(); }
  bool may_pull(std::size_t j) const noexcept {
    return static_cast<std::size_t>(answer_.active[j].row) < problem_.equalities;
  }

  void begin_at_active() noexcept;
  bool release_pulling() noexcept;
  bool most_broken(std::size_t& worst) noexcept;
  std::array<double, QpCone::kEdges> missing(const QpCone& cone) const noexcept;
  QpStatus take(std::size_t index, int max_iterations) noexcept;
  void set_direction(const QpRow& row) noexcept;
  bool leaves(double share) const noexcept;
  void take_off(const Column& shares) noexcept;
  void free_to(std::size_t column) noexcept;
  void set_push() noexcept;
  double longest_step(std::size_t& blocking) const noexcept;
  void append(std::size_t row, double multiplier) noexcept;
  void release(std::size_t leaving) noexcept;

  const columns::Kernels* kernels_ = &columns::builds().best();
  QpProblem problem_;
  QpAnswer answer_;
  StaticVector<std::uint32_t, kMostBroken> broken_rows_, broken_cones_;  // in the last scan of all
  // The normals of the active rows are N = Q R, with Q^T Q the identity and R upper triangular.
  std::array<Column, kMostUnknowns> Q_{}, R_{};  // columns
  Column reciprocal_{};                          // of each entry of R's diagonal
  Column along_{};                               // Q^T g of the row being added
  Column free_{};                                // the part of g that is independent of the active rows
  Column push_{};                                // R^-1 along
  Column work_{};
  double length_sq_ = 0.0;  // of g
  double free_sq_ = 0.0;
  // How far from orthogonal the columns of Q may be, at most, and the free part to them.
  double off_square_ = 0.0, free_off_square_ = 0.0;
};

}  // namespace tactum::inline v0_1
