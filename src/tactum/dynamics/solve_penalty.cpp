#include "tactum/dynamics/solve_penalty.h"

#include <algorithm>
#include <cmath>

#include "tactum/base/tolerances.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// How much stiffer than its bodies a row is that should not yield.
constexpr double kRigid = 1e9;

double rigid_stiffness(const QpRow& row) noexcept {
  const double mobile = mobility(row);
  return mobile > 0.0 ? kRigid / mobile : 0.0;
}

}  // namespace

PenaltySolver::PenaltySolver(std::size_t most_rows) {
  forces_.reserve(most_rows);
  rows_.reserve(most_rows);
}

void PenaltySolver::Row::place(const QpRow::Run& run, std::size_t at) noexcept {
  std::copy_n(run.g.begin(), QpRow::kLongestRun, g.begin() + at);
  for (Index i = 0; i < run.count; ++i) column[at + i] = static_cast<std::uint8_t>(run.first + i);
}

double PenaltySolver::Row::force() const noexcept {
  if (state == kYields) return std::clamp(missing * stiffness, least, most);
  return state == kIdle ? least : most;
}

PenaltySolver::State PenaltySolver::Row::wanted_state() const noexcept {
  const double wanted_force = missing * stiffness;
  return wanted_force < least ? kIdle : wanted_force > most ? kSaturated : kYields;
}

/// Calls visit(number, row, law) with the rows of joints' limits, of contacts, and of joints' dry friction.
template <class Visit>
void PenaltySolver::for_each_row(std::span<const double> stiffness, const ContactProblem& problem,
                                 Visit&& visit) {
  const std::span<const QpRow> rows = problem.row_list();
  const Index first = rows.size() - stiffness.size();  // of the contacts
  for (Index i = 0; i < first; ++i) visit(i, rows[i], ForceLaw{.stiffness = rigid_stiffness(rows[i])});
  for (Index i = first; i < rows.size(); ++i) visit(i, rows[i], ForceLaw{.stiffness = stiffness[i - first]});
  const std::span<const ContactProblem::JointFriction> frictions = problem.joint_frictions();
  for (Index i = 0; i < frictions.size(); ++i) {
    const double most = frictions[i].friction;
    const QpRow& travel = frictions[i].travel;
    visit(rows.size() + i, travel, ForceLaw{rigid_stiffness(travel), -most, most});
  }
}

void PenaltySolver::add(const QpRow& next, const ForceLaw& law) noexcept {
  Row& row = rows_.emplace_back();
  // In the order of the unknowns, for H is kept below its diagonal. The numbers of a run are copied whole,
  // which takes less than a loop over as many as there are; those of the second run overwrite the rest.
  const bool swapped = next.runs[1].first < next.runs[0].first;
  const QpRow::Run& first = next.runs[swapped ? 1 : 0];
  const QpRow::Run& second = next.runs[swapped ? 0 : 1];
  row.place(first, 0);
  row.place(second, first.count);
  row.size = first.count + second.count;
  row.stiffness = law.stiffness;
  row.wanted = next.offset;
  row.least = law.least;
  row.most = law.most;
  row.state = law.least < 0.0 || row.wanted > 0.0 ? kYields : kIdle;
  add_state(row, row.state, 1.0);
  most_wanted_ = std::max(most_wanted_, std::abs(row.wanted));
}

/// Adds the terms of a row in this state to H and to the right side, or removes them.
void PenaltySolver::add_state(const Row& row, State state, double sign) noexcept {
  if (state == kYields) {
    const double weight = sign * row.stiffness;
    for (Index i = 0; i < row.size; ++i) {
      const double scaled = weight * row.g[i];
      right_[row.column[i]] += scaled * row.wanted;
      Column& H = H_[row.column[i]];
      for (Index j = 0; j <= i; ++j) H[row.column[j]] += scaled * row.g[j];
    }
    return;
  }
  const double force = sign * (state == kIdle ? row.least : row.most);
  if (force == 0.0) return;
  for (Index i = 0; i < row.size; ++i) right_[row.column[i]] += force * row.g[i];
}

void PenaltySolver::change(Row& row, State state) noexcept {
  if (state == row.state) return;
  add_state(row, row.state, -1.0);
  row.state = state;
  set_right_range(row);
  add_state(row, state, 1.0);
}

void PenaltySolver::set_right_range(Row& row) const noexcept {
  // For a force with bounds a fraction of these; else the force of the length that may be missing.
  const double tolerance =
      row.most < kUnbounded ? tolerances::kContactVelocity * row.most : allowed_ * row.stiffness;
  row.right.from =
      row.state == kIdle ? -kUnbounded : (row.state == kYields ? row.least : row.most) - tolerance;
  row.right.to =
      row.state == kSaturated ? kUnbounded : (row.state == kYields ? row.most : row.least) + tolerance;
}

/// z = H^-1 right.
void PenaltySolver::newton_step() noexcept {
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

/// Measures by how much each row still closes too far. Returns how many are in a wrong state.
std::size_t PenaltySolver::measure() noexcept {
  Index wrong = 0;
  for (Row& row : rows_) {
    row.missing = row.wanted;
    for (Index i = 0; i < row.size; ++i) row.missing -= row.g[i] * z_[row.column[i]];
    const double force = row.missing * row.stiffness;
    row.wrong = !(force >= row.right.from && force <= row.right.to);  // a NaN is wrong
    wrong += row.wrong ? 1 : 0;
  }
  return wrong;
}

/// Keeps the point from which the next step goes.
void PenaltySolver::keep_point() noexcept {
  std::copy_n(z_.begin(), unknowns_, z_before_.begin());
  for (Row& row : rows_) row.missing_before = row.missing;
}

/// Ends the step where the function no longer falls along it, by the zero of its slope at a share t of the
/// step, which rises with t on a chain of lines.
void PenaltySolver::shorten_step() noexcept {
  double at_start = 0.0;
  double along = 0.0;
  for (Index i = 0; i < unknowns_; ++i) {
    const double d = z_[i] - z_before_[i];
    at_start += z_before_[i] * d;
    along += d * d;
  }
  double rate = 0.0;  // of the slope
  const auto slope = [&](double t) {
    double sum = at_start + t * along;
    rate = along;
    for (const Row& row : rows_) {
      const double closes = row.missing_before - row.missing;
      const double force = row.stiffness * (row.missing_before - t * closes);
      if (force <= row.least) {
        sum -= row.least * closes;
      } else if (force >= row.most) {
        sum -= row.most * closes;
      } else {
        sum -= force * closes;
        rate += row.stiffness * closes * closes;
      }
    }
    return sum;
  };
  if (slope(1.0) <= 0.0) return;
  double falls = 0.0;
  double rises = 1.0;
  double t = 0.0;
  double now = slope(t);
  const double flat = kFlat * std::abs(now);
  for (int i = 0; i < kMostSlopes && std::abs(now) > flat; ++i) {
    (now < 0.0 ? falls : rises) = t;
    t -= now / rate;
    if (!(t > falls && t < rises)) t = 0.5 * (falls + rises);
    now = slope(t);
  }
  for (Index i = 0; i < unknowns_; ++i) z_[i] = z_before_[i] + t * (z_[i] - z_before_[i]);
  for (Row& row : rows_) row.missing = row.missing_before + t * (row.missing - row.missing_before);
}

/// Newton's method on the convex function. A step is a Cholesky factor of I + sum k g g^T over the rows that
/// yield, whose size is the freedom of the bodies, however many rows there are. Begins with the rows that
/// approach too fast, and changes all rows that are in a wrong state after a step; where that makes no fewer
/// wrong, goes on with steps that are no longer than the function falls along them, which always ends.
/// Returns the rounds, 0 when they ran out.
int PenaltySolver::solve_by_newton(std::span<const double> stiffness,
                                   const ContactProblem& problem) noexcept {
  unknowns_ = problem.unknowns();
  for (Index i = 0; i < unknowns_; ++i) {
    right_[i] = 0.0;
    for (Index j = 0; j <= i; ++j) H_[i][j] = i == j ? 1.0 : 0.0;
  }
  rows_.clear();
  most_wanted_ = 0.0;
  for_each_row(stiffness, problem, [&](Index, const QpRow& row, const ForceLaw& law) { add(row, law); });
  allowed_ = tolerances::kContactVelocity * most_wanted_;
  for (Row& row : rows_) set_right_range(row);
  Index fewest = rows_.size() + 1;
  bool guarded = false;
  for (int round = 1; round <= kMostRounds; ++round) {
    if (guarded) keep_point();
    newton_step();
    const Index wrong = measure();
    if (wrong == 0) return round;
    if (guarded) shorten_step();
    guarded |= wrong >= fewest;
    fewest = wrong;
    for (Row& row : rows_)
      if (guarded || row.wrong) change(row, row.wanted_state());
  }
  return 0;
}

/// Projected Gauss-Seidel from first row to last, until a sweep changes almost nothing.
SolverResult PenaltySolver::sweep(std::span<const double> stiffness, int max_sweeps,
                                  ContactProblem& problem) noexcept {
  SolverResult result;
  double* const z = problem.values();
  for (; result.iterations < max_sweeps; ++result.iterations) {
    double largest_wanted = 0.0;
    double largest_change = 0.0;
    for_each_row(stiffness, problem, [&](Index r, const QpRow& row, const ForceLaw& law) {
      if (!(law.stiffness > 0.0)) return;
      const double compliance = 1.0 / law.stiffness;
      const double give = mobility(row) + compliance;
      const double missing = row.offset - dot(row, z) - compliance * forces_[r];
      const double force = std::clamp(forces_[r] + missing / give, law.least, law.most);
      const double change = force - forces_[r];
      if (change == 0.0) return;
      forces_[r] = force;
      push(row, change, z);
      largest_change = std::max(largest_change, std::abs(change) * give);
      largest_wanted = std::max(largest_wanted, std::abs(row.offset));
    });
    result.converged = largest_change <= tolerances::kContactVelocity * largest_wanted;
    if (result.converged) break;
  }
  return result;
}

SolverResult PenaltySolver::solve(std::span<const double> stiffness, int max_sweeps,
                                  ContactProblem& problem) noexcept {
  problem.begin_values();
  const Index number = problem.rows() + problem.joint_frictions().size();
  forces_.resize(number);
  if (number == 0) return {.iterations = 0, .converged = true};
  if (problem.unknowns() <= kMostUnknowns) {
    const int rounds = solve_by_newton(stiffness, problem);
    if (rounds > 0) {
      for (Index i = 0; i < number; ++i) forces_[i] = rows_[i].force();
      std::copy_n(z_.begin(), unknowns_, problem.values());
      return {.iterations = rounds, .converged = true};
    }
  }
  forces_.assign(number, 0.0);
  return sweep(stiffness, max_sweeps, problem);
}

}  // namespace tactum::inline v0_1
