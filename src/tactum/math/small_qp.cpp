#include "tactum/math/small_qp.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "tactum/base/tolerances.h"
#include "tactum/math/types.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;
constexpr double kFar = std::numeric_limits<double>::infinity();

/// A row that is linearly independent of those begun with by less than this fraction waits until it is
/// broken: taken as an equation, rows that almost agree would give forces that are as many times too large.
constexpr double kWorthBeginning = 1e-3;

/// For one body all rows are scanned before each is added. Where several sets of forces hold it equally, the
/// order decides which is found: with less than the whole order a peg jammed 10 mm deep wedged from 1.07
/// times the analytic friction instead of 1.03.
constexpr Index kFewUnknowns = 6;

/// How far from orthogonal the columns of Q may be; a row whose independent part is so small that rounding
/// would lead farther is orthogonalised once more.
constexpr double kRounding = std::numeric_limits<double>::epsilon();
constexpr double kSquare = 5e4 * kRounding;

/// Two lanes, which every processor has; sums are taken in the same order everywhere.
using Lanes = double __attribute__((vector_size(16)));

Lanes lanes(const double* x) noexcept {
  Lanes both;
  std::memcpy(&both, x, sizeof both);
  return both;
}

/// The next multiple of eight; the numbers between are zero or are multiplied by zeros.
Index whole(Index n) noexcept { return (n + 7) & ~Index(7); }

/// Turns the pair (a, b) so that b vanishes.
struct Turn {
  double cosine = 1.0, sine = 0.0;

  Turn(double a, double b) noexcept {
    const double length = std::sqrt(a * a + b * b);
    if (length == 0.0) return;
    cosine = a / length;
    sine = b / length;
  }
  void apply(double& a, double& b) const noexcept {
    const double turned = cosine * a + sine * b;
    b = cosine * b - sine * a;
    a = turned;
  }
};

/// The edges of a cone, one array each, for loops over lanes.
struct Around {
  std::array<double, QpCone::kAround> cosine{}, sine{};
  Around() {
    for (Index k = 0; k < QpCone::kAround; ++k) {
      const double angle = 2.0 * kPi * static_cast<double>(k) / static_cast<double>(QpCone::kAround);
      cosine[k] = std::cos(angle);
      sine[k] = std::sin(angle);
    }
  }
};
const Around kDirections;

}  // namespace

double dot(const QpRow& row, const double* x) noexcept {
  Lanes sum{};
  for (const QpRow::Run& run : row.runs) {
    const double* const at = x + run.first;
    const double* const g = run.g.data();
    sum += (lanes(g) * lanes(at) + lanes(g + 2) * lanes(at + 2)) + lanes(g + 4) * lanes(at + 4);
  }
  return sum[0] + sum[1];
}

QpCone::Direction QpCone::direction(Index k) noexcept { return {kDirections.cosine[k], kDirections.sine[k]}; }

/// An edge is off + x one + y other of the four.
struct QpCone::Mixture {
  double x, y;
  const QpRow *one, *other;
};

QpCone::Mixture QpCone::mixture(Index k) const noexcept {
  if (k >= kAround) return {k == kAround ? -twist : twist, 0.0, &about, &about};
  return {-slope * direction(k).cosine, -slope * direction(k).sine, &along, &across};
}

double QpCone::offset(Index k) const noexcept {
  const Mixture mixed = mixture(k);
  return off.offset + mixed.x * mixed.one->offset + mixed.y * mixed.other->offset + more[k];
}

QpRow QpCone::edge(Index k) const noexcept {
  const Mixture mixed = mixture(k);
  QpRow row = off;
  for (Index r = 0; r < 2; ++r)
    for (Index i = 0; i < QpRow::kLongestRun; ++i)
      row.runs[r].g[i] += mixed.x * mixed.one->runs[r].g[i] + mixed.y * mixed.other->runs[r].g[i];
  row.offset = offset(k);
  return row;
}

QpRow QpProblem::row(Index number) const noexcept {
  if (number < rows.size()) return rows[number];
  const Index edge = number - rows.size();
  return cones[edge / QpCone::kEdges].edge(edge % QpCone::kEdges);
}

double QpProblem::offset(Index number) const noexcept {
  if (number < rows.size()) return rows[number].offset;
  const Index edge = number - rows.size();
  return cones[edge / QpCone::kEdges].offset(edge % QpCone::kEdges);
}

void SmallQp::begin(const QpProblem& problem, std::span<const int> first) noexcept {
  problem_ = problem;
  answer_.active.clear();
  off_square_ = 0.0;
  for (Index row = 0; row < problem.equalities && count() < problem.unknowns; ++row) {
    set_direction(problem.rows[row]);
    if (leaves(tolerances::kDependentRow)) append(row, 0.0);
  }
  for (const int row : first)
    if (count() < problem.unknowns) {
      set_direction(problem.row(Index(row)));
      if (leaves(kWorthBeginning)) append(Index(row), 0.0);
    }
}

const QpAnswer& SmallQp::solve_on(const QpProblem& problem, int max_iterations) noexcept {
  problem_ = problem;
  broken_rows_.clear();
  broken_cones_.clear();
  for (Index j = count(); j-- > 0;)
    if (Index(answer_.active[j].row) >= problem.size()) release(j);
  answer_.iterations = 0;
  answer_.status = QpStatus::kSolved;
  begin_at_active();
  for (Index worst = 0; answer_.status == QpStatus::kSolved && most_broken(worst);)
    answer_.status = take(worst, max_iterations);
  return answer_;
}

/// The nearest point that keeps the active rows, without those that would have to pull.
void SmallQp::begin_at_active() noexcept {
  Column& y = along_;  // z = Q y, R^T y = the offsets: still so after a row was dropped
  y.fill(0.0);
  for (Index j = 0; j < count(); ++j) {
    const double rest = problem_.offset(Index(answer_.active[j].row));
    y[j] = (rest - kernels_->dot(R_[j].data(), y.data(), whole(j))) * reciprocal_[j];
  }
  for (set_push(); release_pulling(); set_push()) ++answer_.iterations;
  for (Index j = 0; j < count(); ++j) answer_.active[j].multiplier = push_[j];
  answer_.z.fill(0.0);
  kernels_->combine(Q_[0].data(), count(), y.data(), 1.0, whole(problem_.unknowns), answer_.z.data());
}

/// Drops the row that would have to pull most, if any would.
bool SmallQp::release_pulling() noexcept {
  Index first = 0;  // behind the equations, which come first
  while (first < count() && may_pull(first)) ++first;
  const auto end = push_.begin() + static_cast<std::ptrdiff_t>(count());
  const auto least = std::min_element(push_.begin() + static_cast<std::ptrdiff_t>(first), end);
  if (least == end || !(*least < 0.0)) return false;
  release(static_cast<Index>(least - push_.begin()));
  return true;
}

double SmallQp::missing(const QpRow& row) const noexcept { return row.offset - dot(row, answer_.z.data()); }

/// By how much each edge of a cone is missed.
std::array<double, QpCone::kEdges> SmallQp::missing(const QpCone& cone) const noexcept {
  const double off = missing(cone.off);
  const double along = cone.slope * missing(cone.along);
  const double across = cone.slope * missing(cone.across);
  const double about = cone.twist * missing(cone.about);
  std::array<double, QpCone::kEdges> by{};
  for (Index k = 0; k < QpCone::kAround; ++k)
    by[k] = cone.more[k] + (off - (kDirections.cosine[k] * along + kDirections.sine[k] * across));
  by[QpCone::kAround] = cone.more[QpCone::kAround] + (off - about);
  by[QpCone::kAround + 1] = cone.more[QpCone::kAround + 1] + (off + about);
  return by;
}

/// Finds a row that is missed by most, if any is by more than the tolerance.
bool SmallQp::most_broken(Index& worst) noexcept {
  double most = problem_.tolerance;
  bool found = false;
  const auto compare = [&](Index number, double by) {
    if (!(by > most)) return;
    most = by;
    worst = number;
    found = true;
  };
  const auto look_at_row = [&](Index row) {
    const double by = missing(problem_.rows[row]);
    compare(row, by);
    return by > problem_.tolerance;
  };
  const auto look_at_cone = [&](Index cone) {
    const std::array<double, QpCone::kEdges> by = missing(problem_.cones[cone]);
    const Index worst_edge = static_cast<Index>(std::max_element(by.begin(), by.end()) - by.begin());
    compare(problem_.rows.size() + cone * QpCone::kEdges + worst_edge, by[worst_edge]);
    return by[worst_edge] > problem_.tolerance;
  };
  for (const std::uint32_t row : broken_rows_) look_at_row(row);
  for (const std::uint32_t cone : broken_cones_) look_at_cone(cone);
  if (found) return true;
  broken_rows_.clear();
  broken_cones_.clear();
  const bool remembers = problem_.unknowns > kFewUnknowns;
  for (Index row = 0; row < problem_.rows.size(); ++row)
    if (look_at_row(row) && remembers) broken_rows_.push_back(static_cast<std::uint32_t>(row));
  for (Index cone = 0; cone < problem_.cones.size(); ++cone)
    if (look_at_cone(cone) && remembers) broken_cones_.push_back(static_cast<std::uint32_t>(cone));
  return found;
}

/// Moves until `row` is kept.
QpStatus SmallQp::take(Index index, int max_iterations) noexcept {
  const QpRow row = problem_.row(index);
  double multiplier = 0.0;
  set_direction(row);
  while (answer_.iterations < max_iterations) {
    ++answer_.iterations;
    const bool dependent = !leaves(tolerances::kDependentRow);
    set_push();
    const double whole_step = dependent ? kFar : missing(row) / free_sq_;
    Index blocking = 0;
    const double allowed = longest_step(blocking);
    // No row can be dropped: there is no solution, or a number is not finite (a scene with absurd settings).
    if (allowed == kFar && (dependent || !(whole_step < kFar))) return QpStatus::kInfeasible;
    const double step = whole_step <= allowed ? whole_step : allowed;
    for (Index j = 0; j < count(); ++j) answer_.active[j].multiplier -= step * push_[j];
    multiplier += step;
    if (!dependent)
      kernels_->combine(free_.data(), 1, &step, 1.0, whole(problem_.unknowns), answer_.z.data());
    if (whole_step <= allowed) {
      append(index, multiplier);
      return QpStatus::kSolved;
    }
    release(blocking);
    free_to(count());
  }
  return QpStatus::kBounded;
}

/// Splits g into its part along the active rows and the free part, the direction of the step.
void SmallQp::set_direction(const QpRow& row) noexcept {
  const Index q = count();
  const Index n = whole(problem_.unknowns);
  std::fill_n(free_.begin(), n, 0.0);
  for (const QpRow::Run& run : row.runs)
    for (Index i = 0; i < run.count; ++i) free_[run.first + i] = run.g[i];
  length_sq_ = kernels_->dot(free_.data(), free_.data(), n);
  for (Index k = 0; k < q; ++k) along_[k] = dot(row, Q_[k].data());
  take_off(along_);
  free_off_square_ = std::max(off_square_, kRounding) * std::sqrt(length_sq_ / free_sq_);
  if (free_off_square_ < kSquare) return;
  kernels_->dots(Q_[0].data(), q, free_.data(), n, work_.data());
  take_off(work_);
  for (Index k = 0; k < q; ++k) along_[k] += work_[k];
  free_off_square_ = kRounding;
}

/// Whether the free part is more than this fraction of the row.
bool SmallQp::leaves(double share) const noexcept { return free_sq_ > share * share * length_sq_; }

/// Subtracts the columns of Q, each times its factor, from the free part.
void SmallQp::take_off(const Column& shares) noexcept {
  const Index n = whole(problem_.unknowns);
  kernels_->combine(Q_[0].data(), count(), shares.data(), -1.0, n, free_.data());
  free_sq_ = kernels_->dot(free_.data(), free_.data(), n);
}

/// Makes the direction of the column of Q that was dropped last free again.
void SmallQp::free_to(Index column) noexcept {
  const Index n = whole(problem_.unknowns);
  kernels_->combine(Q_[column].data(), 1, &along_[column], 1.0, n, free_.data());
  free_sq_ = kernels_->dot(free_.data(), free_.data(), n);
}

/// The multipliers of the active rows against a force along `along`.
void SmallQp::set_push() noexcept {
  std::copy_n(along_.begin(), count(), work_.begin());
  kernels_->solve_upper(R_[0].data(), reciprocal_.data(), count(), work_.data(), push_.data());
}

/// How far the step may go until an active row would pull, and which one.
double SmallQp::longest_step(Index& blocking) const noexcept {
  double longest = kFar;
  for (Index j = 0; j < count(); ++j) {
    if (push_[j] <= 0.0 || may_pull(j)) continue;
    const double step = answer_.active[j].multiplier / push_[j];
    if (step < longest) {
      longest = step;
      blocking = j;
    }
  }
  return longest;
}

/// Adds the row of the last direction to the active set.
void SmallQp::append(Index row, double multiplier) noexcept {
  const Index q = count();
  const double length = std::sqrt(free_sq_);
  Q_[q].fill(0.0);
  for (Index i = 0; i < problem_.unknowns; ++i) Q_[q][i] = free_[i] / length;
  std::copy_n(along_.begin(), q, R_[q].begin());
  std::fill(R_[q].begin() + static_cast<std::ptrdiff_t>(q), R_[q].end(), 0.0);
  R_[q][q] = length;
  reciprocal_[q] = 1.0 / length;
  answer_.active.push_back({static_cast<int>(row), multiplier});
  off_square_ = std::max(off_square_, free_off_square_);
}

/// Takes a column out of R and makes the rest triangular again. Its own part of g and of Q comes last.
void SmallQp::release(Index leaving) noexcept {
  const Index last = count() - 1;
  for (Index j = leaving; j < last; ++j) {
    answer_.active[j] = answer_.active[j + 1];
    std::copy_n(R_[j + 1].begin(), j + 2, R_[j].begin());
  }
  answer_.active.pop_back();
  for (Index j = leaving; j < last; ++j) {
    const Turn turn(R_[j][j], R_[j][j + 1]);
    for (Index k = j; k < last; ++k) turn.apply(R_[k][j], R_[k][j + 1]);
    R_[j][j + 1] = 0.0;
    reciprocal_[j] = 1.0 / R_[j][j];
    turn.apply(along_[j], along_[j + 1]);
    kernels_->turn(turn.cosine, turn.sine, whole(problem_.unknowns), Q_[j].data(), Q_[j + 1].data());
  }
}

}  // namespace tactum::inline v0_1
