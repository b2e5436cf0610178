#pragma once
/// The solver of the contact problem whose rows yield: the penalty law, for all contacts together and
/// implicitly.
///
/// The published law pushes with  F = k (delta - d)  while d < delta [Gregory 2000, 5.2]; D_p is -d, so the
/// same line serves the overlapping pair, F = k (delta + D_p). Applied with the distance of the *start* of
/// the step, such a spring shakes as soon as k h^2 exceeds the mass it pushes on, and the proxy weighs
/// nothing. So the law is asked to hold at the *end* of the step: with  d' = d + n . (x_a - x_b),
///
///     n . (x_a - x_b) + F / k = delta - d,     F >= 0,
///
/// which is a linear complementarity problem with a positive definite matrix, and its other side the least of
/// a convex function of the bodies' displacements. With the rows  g_i . z >= b_i  of the contact problem that
/// is
///
///     |z|^2 / 2 + sum_i k_i max(0, b_i - g_i z)^2 / 2:
///
/// quadratic while the same rows push. It is found exactly by Newton's method while at most 36 unknowns (six
/// free bodies) take part: two rounds as a rule, each linear in the rows. Beyond that by projected
/// Gauss-Seidel with a bounded number of sweeps (two gears with 14 rows took it 54). It is stable for every
/// k, h and mass, and at rest its forces are the published ones exactly.
///
/// Limits of joints are rows as stiff as rounding allows, and so is dry friction, whose force is bounded.

#include <array>
#include <cstdint>
#include <span>

#include "tactum/dynamics/contact_problem.h"
#include "tactum/dynamics/contact_row.h"

namespace tactum::inline v0_1 {

class PenaltySolver {
 public:
  /// Has room for problems of so many rows, the joints' dry friction included. Allocates; solve() does not.
  explicit PenaltySolver(std::size_t most_rows);

  /// Solves the problem, which has no more rows than there is room for. `stiffness` is that of its contact
  /// rows, which are the last ones [N/m]. `max_sweeps` bounds the sweeps; Newton's method has a bound of its
  /// own.
  SolverResult solve(std::span<const double> stiffness, int max_sweeps, ContactProblem& problem) noexcept;

  /// The force of every row of the problem that was solved last, and of every joint's dry friction behind
  /// them [N].
  std::span<const double> forces() const noexcept { return forces_; }

 private:
  static constexpr int kMostRounds = 24;  // of Newton's method: two are usual
  static constexpr int kMostSlopes = 30;
  static constexpr double kFlat = 0.1;  // of the slope at the start

  /// The law of a row's force:  stiffness (offset - g z), between two bounds.
  struct ForceLaw {
    double stiffness = 0.0;                 // [N/m]
    double least = 0.0, most = kUnbounded;  // [N]
  };
  /// The row's force is the least, follows the law, or is the most.
  enum State : std::uint8_t { kIdle, kYields, kSaturated };

  struct Range {
    double from, to;
  };
  struct Row {
    std::size_t size;  // of g, where it is not zero: the unknowns of both bodies, in order
    std::array<std::uint8_t, 12> column;
    static_assert(kMostUnknowns <= 256);
    std::array<double, 12> g;
    double stiffness, wanted, least, most;
    double missing;         // offset - g z, since the last step
    double missing_before;  // before it, where the step is guarded
    Range right;            // of forces for which the state is right
    State state;
    bool wrong;  // the state, after the last step

    void place(const QpRow::Run& run, std::size_t at) noexcept;
    double force() const noexcept;
    State wanted_state() const noexcept;
  };
  using Matrix = std::array<std::array<double, kMostUnknowns>, kMostUnknowns>;
  using Column = std::array<double, kMostUnknowns>;

  template <class Visit>
  static void for_each_row(std::span<const double> stiffness, const ContactProblem& problem, Visit&& visit);
  SolverResult sweep(std::span<const double> stiffness, int max_sweeps, ContactProblem& problem) noexcept;
  int solve_by_newton(std::span<const double> stiffness, const ContactProblem& problem) noexcept;
  void add(const QpRow& next, const ForceLaw& law) noexcept;
  void add_state(const Row& row, State state, double sign) noexcept;
  void change(Row& row, State state) noexcept;
  void set_right_range(Row& row) const noexcept;
  void newton_step() noexcept;
  std::size_t measure() noexcept;
  void keep_point() noexcept;
  void shorten_step() noexcept;

  ReservedVector<double> forces_;
  // Of Newton's method.
  ReservedVector<Row> rows_;
  std::size_t unknowns_ = 0;
  double most_wanted_ = 0.0;
  double allowed_ = 0.0;  // so much may be missing [m]
  Matrix H_{}, L_{};
  Column right_{}, z_{}, z_before_{}, inverse_{};
};

}  // namespace tactum::inline v0_1
