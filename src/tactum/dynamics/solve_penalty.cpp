#include "tactum/dynamics/solve_penalty.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "tactum/base/tolerances.h"

namespace tactum {
namespace {

using Index = std::size_t;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// How much stiffer than its bodies a row is that should not yield.
constexpr double kRigid = 1e9;

/// A row of the problem with the law of its force:  stiffness (offset - g z), between two bounds.
struct YieldingRow {
  QpRow row;
  double stiffness = 0.0;                // [N/m]
  double least = 0.0, most = kInfinity;  // [N]
};

double rigid_stiffness(const QpRow& row) noexcept {
  const double mobile = mobility(row);
  return mobile > 0.0 ? kRigid / mobile : 0.0;
}

/// The rows of joints' limits, of contacts, and of joints' dry friction, in this order.
YieldingRow yielding_row(Index number, std::span<const ContactRow> contacts, Index first,
                         const ContactProblem& problem) noexcept {
  const std::span<const QpRow> rows = problem.row_list();
  if (number < rows.size()) {
    YieldingRow next{.row = rows[number]};
    next.stiffness = number >= first ? contacts[number - first].stiffness : rigid_stiffness(next.row);
    return next;
  }
  const ContactProblem::JointFriction& friction = problem.joint_frictions()[number - rows.size()];
  YieldingRow next;
  next.row.runs[0] = {
      static_cast<std::uint32_t>(problem.bodies()[friction.body].first), 1, {friction.per_unknown}};
  next.row.offset = -friction.free_travel;
  next.stiffness = rigid_stiffness(next.row);
  next.least = -friction.friction;
  next.most = friction.friction;
  return next;
}

/// Newton's method on the convex function. A step is a Cholesky factor of I + sum k g g^T over the rows that
/// yield, whose size is the freedom of the bodies, however many rows there are.
class Newton {
 public:
  static constexpr Index kMostRows = 128;

  // Not filled: add() and solve() write what is read.
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init,modernize-use-equals-default)
  explicit Newton(Index unknowns) noexcept : unknowns_(unknowns) {
    for (Index i = 0; i < unknowns_; ++i) {
      right_[i] = 0.0;
      for (Index j = 0; j <= i; ++j) H_[i][j] = i == j ? 1.0 : 0.0;
    }
  }

  void add(const YieldingRow& next) {
    Row& row = rows_[n_++];
    row.size = 0;
    // In the order of the unknowns, for H is kept below its diagonal.
    const bool swapped = next.row.runs[1].first < next.row.runs[0].first;
    for (const Index r : {Index(swapped ? 1 : 0), Index(swapped ? 0 : 1)}) {
      const QpRow::Run& run = next.row.runs[r];
      for (Index i = 0; i < run.count; ++i) {
        row.column[row.size] = static_cast<std::uint8_t>(run.first + i);
        row.g[row.size++] = run.g[i];
      }
    }
    row.stiffness = next.stiffness;
    row.wanted = next.row.offset;
    row.least = next.least;
    row.most = next.most;
    row.state = next.least < 0.0 || row.wanted > 0.0 ? kYields : kIdle;
    add_state(row, row.state, 1.0);
    most_wanted_ = std::max(most_wanted_, std::abs(row.wanted));
  }

  /// Begins with the rows that approach too fast; where the number of wrong rows does not sink it changes one
  /// at a time [Portugal 1994]. Returns the rounds, 0 when they ran out.
  int solve() {
    allowed_ = tolerances::kContactVelocity * most_wanted_;
    Index fewest = n_ + 1;
    int tries = kTries;
    for (int round = 1; round <= kMostRounds; ++round) {
      newton_step();
      Index wrong = 0;
      for (Index i = 0; i < n_; ++i) {
        rows_[i].missing = missing(rows_[i]);
        wrong += is_wrong(rows_[i]) ? 1 : 0;
      }
      if (wrong == 0) return round;
      if (wrong < fewest) {
        fewest = wrong;
        tries = kTries;
      } else {
        --tries;
      }
      for (Index i = n_; i-- > 0;) {
        if (!is_wrong(rows_[i])) continue;
        change(rows_[i], wanted_state(rows_[i]));
        if (tries < 0) break;
      }
    }
    return 0;
  }

  double force(Index i) const {
    const Row& row = rows_[i];
    if (row.state == kYields) return std::clamp(row.missing * row.stiffness, row.least, row.most);
    return row.state == kIdle ? row.least : row.most;
  }
  double value(Index unknown) const { return z_[unknown]; }

 private:
  static constexpr int kTries = 3;
  static constexpr int kMostRounds = 24;  // two are usual

  /// The row's force is the least, follows the law, or is the most.
  enum State : std::uint8_t { kIdle, kYields, kSaturated };

  struct Row {
    Index size;  // of g, where it is not zero: the unknowns of both bodies, in order
    std::array<std::uint8_t, 12> column;
    static_assert(kMostUnknowns <= 256);
    std::array<double, 12> g;
    double stiffness, wanted, least, most;
    double missing;  // offset - g z, since the last step
    State state;
  };

  /// Adds the terms of a row in this state to H and to the right side, or removes them.
  void add_state(const Row& row, State state, double sign) {
    if (state == kYields) {
      const double weight = sign * row.stiffness;
      for (Index i = 0; i < row.size; ++i) {
        const double scaled = weight * row.g[i];
        right_[row.column[i]] += scaled * row.wanted;
        double* const H = H_[row.column[i]];
        for (Index j = 0; j <= i; ++j) H[row.column[j]] += scaled * row.g[j];
      }
      return;
    }
    const double force = sign * (state == kIdle ? row.least : row.most);
    if (force == 0.0) return;
    for (Index i = 0; i < row.size; ++i) right_[row.column[i]] += force * row.g[i];
  }
  void change(Row& row, State state) {
    add_state(row, row.state, -1.0);
    row.state = state;
    add_state(row, state, 1.0);
  }

  /// z = H^-1 right.
  void newton_step() {
    for (Index i = 0; i < unknowns_; ++i) {
      double y = right_[i];
      for (Index j = 0; j <= i; ++j) {
        double sum = H_[i][j];
        for (Index k = 0; k < j; ++k) sum -= L_[i][k] * L_[j][k];
        if (j < i) {
          L_[i][j] = sum * inverse_[j];
          y -= L_[i][j] * z_[j];
        } else {
          inverse_[i] = 1.0 / std::sqrt(sum);
        }
      }
      z_[i] = y * inverse_[i];
    }
    for (Index i = unknowns_; i-- > 0;) {
      double sum = z_[i];
      for (Index k = i + 1; k < unknowns_; ++k) sum -= L_[k][i] * z_[k];
      z_[i] = sum * inverse_[i];
    }
  }

  /// By how much the row still closes too far.
  double missing(const Row& row) const {
    double sum = row.wanted;
    for (Index i = 0; i < row.size; ++i) sum -= row.g[i] * z_[row.column[i]];
    return sum;
  }
  static State wanted_state(const Row& row) {
    const double force = row.missing * row.stiffness;
    return force < row.least ? kIdle : force > row.most ? kSaturated : kYields;
  }
  bool is_wrong(const Row& row) const {
    const double force = row.missing * row.stiffness;
    // For a force with bounds a fraction of these; else the force of the length that may be missing.
    const double tolerance =
        row.most < kInfinity ? tolerances::kContactVelocity * row.most : allowed_ * row.stiffness;
    switch (row.state) {
      case kIdle:
        return !(force <= row.least + tolerance);  // a NaN is wrong
      case kYields:
        return !(force >= row.least - tolerance && force <= row.most + tolerance);
      case kSaturated:
        break;
    }
    return !(force >= row.most - tolerance);
  }

  Index n_ = 0, unknowns_;
  double most_wanted_ = 0.0;
  double allowed_ = 0.0;  // so much may be missing [m]
  Row rows_[kMostRows];
  double H_[kMostUnknowns][kMostUnknowns], L_[kMostUnknowns][kMostUnknowns];
  double right_[kMostUnknowns], z_[kMostUnknowns], inverse_[kMostUnknowns];
};

/// Projected Gauss-Seidel from first row to last, until a sweep changes almost nothing.
SolverResult sweep(std::span<const ContactRow> contacts, Index first, int max_sweeps,
                   ReservedVector<double>& forces, ContactProblem& problem) {
  SolverResult result;
  double* const z = problem.values();
  for (; result.iterations < max_sweeps; ++result.iterations) {
    double largest_wanted = 0.0;
    double largest_change = 0.0;
    for (Index r = 0; r < forces.size(); ++r) {
      const YieldingRow next = yielding_row(r, contacts, first, problem);
      if (!(next.stiffness > 0.0)) continue;
      const double compliance = 1.0 / next.stiffness;
      const double give = mobility(next.row) + compliance;
      const double missing = next.row.offset - dot(next.row, z) - compliance * forces[r];
      const double force = std::clamp(forces[r] + missing / give, next.least, next.most);
      const double change = force - forces[r];
      if (change == 0.0) continue;
      forces[r] = force;
      push(next.row, change, z);
      largest_change = std::max(largest_change, std::abs(change) * give);
      largest_wanted = std::max(largest_wanted, std::abs(next.row.offset));
    }
    result.converged = largest_change <= tolerances::kContactVelocity * largest_wanted;
    if (result.converged) break;
  }
  return result;
}

}  // namespace

SolverResult solve_penalty(std::span<ContactRow> rows, std::size_t first, double h, int max_sweeps,
                           ReservedVector<double>& forces, ContactProblem& problem) noexcept {
  problem.begin_values();
  const Index number = problem.rows() + problem.joint_frictions().size();
  SolverResult result{.iterations = 0, .converged = true};
  if (number == 0) return result;
  forces.assign(number, 0.0);
  int rounds = 0;
  if (number <= Newton::kMostRows && problem.unknowns() <= kMostUnknowns) {
    Newton newton(problem.unknowns());
    for (Index i = 0; i < number; ++i) newton.add(yielding_row(i, rows, first, problem));
    rounds = newton.solve();
    if (rounds > 0) {
      for (Index i = 0; i < number; ++i) forces[i] = newton.force(i);
      for (Index i = 0; i < problem.unknowns(); ++i) problem.values()[i] = newton.value(i);
      result.iterations = rounds;
    }
  }
  if (rounds == 0) result = sweep(rows, first, max_sweeps, forces, problem);
  for (Index i = 0; i < rows.size(); ++i) rows[i].impulse = forces[first + i] * h;
  return result;
}

}  // namespace tactum
