#include "tactum/math/small_qp.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "tactum/base/tolerances.h"

namespace tactum {
namespace {

using Index = std::size_t;
constexpr double kFar = std::numeric_limits<double>::infinity();

/// A row of which less than this share is left beside those begun with waits until it is broken: taken as an
/// equation, what rows all but agree on would be solved for with forces that are as many times too large.
constexpr double kWorthBeginning = 1e-3;

/// Of one body all rows are scanned before each is taken in. Where several sets of forces hold it alike, the
/// order decides which is found: with less than the whole order a peg jammed 10 mm deep wedged from 1.07
/// times the analytic friction instead of 1.03.
constexpr Index kFewUnknowns = 6;

/// How far from square the columns of Q may be; a row of which so little is left that rounding would lead
/// farther is made square to them once more.
constexpr double kRounding = std::numeric_limits<double>::epsilon();
constexpr double kSquare = 5e4 * kRounding;

/// Two lanes, which every processor has; sums are taken in the same order everywhere.
using Lanes = double __attribute__((vector_size(16)));

Lanes lanes(const double* x) noexcept {
  Lanes both;
  std::memcpy(&both, x, sizeof both);
  return both;
}

/// The next multiple of eight; what lies between is zero or meets zeros.
Index whole(Index n) noexcept { return (n + 7) & ~Index(7); }

/// What eight entries of columns sum up to, each column times its number.
struct Eight {
  Lanes sum[4];

  explicit Eight(const double* x) noexcept : sum{lanes(x), lanes(x + 2), lanes(x + 4), lanes(x + 6)} {}
  void add(double times, const double* x) noexcept {
    for (Index i = 0; i < 4; ++i) sum[i] += times * lanes(x + 2 * i);
  }
  void store(double* x) const noexcept { std::memcpy(x, sum, sizeof sum); }
};

void add(double times, const double* x, Index n, double* to) noexcept {
  for (Index i = 0; i < n; i += 2) {
    const Lanes sum = lanes(to + i) + times * lanes(x + i);
    std::memcpy(to + i, &sum, sizeof sum);
  }
}

double dot(const double* x, const double* y, Index n) noexcept {
  Lanes even{}, odd{};
  for (Index i = 0; i < whole(n); i += 4) {
    even += lanes(x + i) * lanes(y + i);
    odd += lanes(x + i + 2) * lanes(y + i + 2);
  }
  even += odd;
  return even[0] + even[1];
}

double dot(const QpRow& row, const double* x) noexcept {
  Lanes sum{};
  for (const QpRow::Run& run : row.runs) {
    const double* const at = x + run.first;
    const double* const g = run.g.data();
    sum += (lanes(g) * lanes(at) + lanes(g + 2) * lanes(at + 2)) + lanes(g + 4) * lanes(at + 4);
  }
  return sum[0] + sum[1];
}

/// Turns the pair (a, b) so that b vanishes.
struct Turn {
  double cosine = 1.0, sine = 0.0;

  Turn(double a, double b) noexcept {
    const double length = std::sqrt(a * a + b * b);
    if (length == 0.0) return;
    cosine = a / length;
    sine = b / length;
  }
  template <class Number>
  void apply(Number& a, Number& b) const noexcept {
    const Number turned = cosine * a + sine * b;
    b = cosine * b - sine * a;
    a = turned;
  }
};

}  // namespace

void SmallQp::begin(const QpProblem& problem, std::span<const int> first) noexcept {
  problem_ = problem;
  answer_.active.clear();
  off_square_ = 0.0;
  for (const int row : first)
    if (count() < problem.unknowns && set_direction(problem.rows[Index(row)], kWorthBeginning))
      append(Index(row), 0.0);
}

const QpAnswer& SmallQp::solve_on(const QpProblem& problem, int max_iterations) noexcept {
  problem_ = problem;
  broken_.clear();
  for (Index j = count(); j-- > 0;)
    if (Index(answer_.active[j].row) >= problem.rows.size()) release(j);
  answer_.iterations = 0;
  answer_.status = QpStatus::kSolved;
  begin_at_active();
  for (Index worst = 0; answer_.status == QpStatus::kSolved && most_broken(worst);)
    answer_.status = take(worst, max_iterations);
  return answer_;
}

/// The nearest point that keeps the rows that hold, without those that would have to pull.
void SmallQp::begin_at_active() noexcept {
  for (;;) {
    const Index q = count();
    Column& y = along_;  // z = Q y
    y.fill(0.0);
    for (Index j = 0; j < q; ++j) {
      const double rest = problem_.rows[Index(answer_.active[j].row)].offset;
      y[j] = (rest - dot(R_[j].data(), y.data(), j)) * diagonal_[j];
    }
    set_push();
    Index pulling = q;
    double most = 0.0;
    for (Index j = q; j-- > 0;) {
      answer_.active[j].multiplier = push_[j];
      if (push_[j] < most) {
        most = push_[j];
        pulling = j;
      }
    }
    if (pulling < q) {
      ++answer_.iterations;
      release(pulling);
      continue;
    }
    answer_.z.fill(0.0);
    for (Index i = 0; i < problem_.unknowns; i += 8) {
      Eight eight(answer_.z.data() + i);
      for (Index k = 0; k < q; ++k) eight.add(y[k], Q_[k].data() + i);
      eight.store(answer_.z.data() + i);
    }
    return;
  }
}

double SmallQp::missing(const QpRow& row) const noexcept { return row.offset - dot(row, answer_.z.data()); }

/// A row that is missed by most, if any is by more than the slack.
bool SmallQp::most_broken(Index& worst) noexcept {
  double most = problem_.slack;
  bool found = false;
  const auto look_at = [&](Index row) {
    const double by = missing(problem_.rows[row]);
    if (!(by > problem_.slack)) return false;
    if (by > most) {
      most = by;
      worst = row;
      found = true;
    }
    return true;
  };
  for (const std::uint32_t row : broken_) look_at(row);
  if (found) return true;
  broken_.clear();
  const bool remembers = problem_.unknowns > kFewUnknowns;
  for (Index row = 0; row < problem_.rows.size(); ++row)
    if (look_at(row) && remembers) broken_.push_back(static_cast<std::uint32_t>(row));
  return found;
}

/// Walks until `row` is kept.
QpStatus SmallQp::take(Index index, int max_iterations) noexcept {
  const QpRow& row = problem_.rows[index];
  double multiplier = 0.0;
  while (answer_.iterations < max_iterations) {
    ++answer_.iterations;
    const bool dependent = !set_direction(row, tolerances::kDependentRow);
    set_push();
    const double whole_step = dependent ? kFar : missing(row) / free_sq_;
    Index blocking = 0;
    const double allowed = longest_step(blocking);
    // No row lets go: there is no way, or the numbers are none (a scene that was set absurdly).
    if (allowed == kFar && (dependent || !(whole_step < kFar))) return QpStatus::kInfeasible;
    const double step = whole_step <= allowed ? whole_step : allowed;
    for (Index j = 0; j < count(); ++j) answer_.active[j].multiplier -= step * push_[j];
    multiplier += step;
    if (!dependent) add(step, free_.data(), whole(problem_.unknowns), answer_.z.data());
    if (whole_step <= allowed) {
      append(index, multiplier);
      return QpStatus::kSolved;
    }
    release(blocking);
  }
  return QpStatus::kBounded;
}

/// Splits g into what rows that hold see of it and what is free, the way to go. False when that is no more
/// than such a share.
bool SmallQp::set_direction(const QpRow& row, double least_share) noexcept {
  const Index q = count();
  const Index n = whole(problem_.unknowns);
  std::fill_n(free_.begin(), n, 0.0);
  for (const QpRow::Run& run : row.runs)
    for (Index i = 0; i < run.count; ++i) free_[run.first + i] = run.g[i];
  const double length_sq = dot(free_.data(), free_.data(), n);
  for (Index k = 0; k < q; ++k) along_[k] = dot(row, Q_[k].data());
  take_off(along_);
  free_off_square_ = std::max(off_square_, kRounding) * std::sqrt(length_sq / free_sq_);
  if (!(free_off_square_ < kSquare)) {
    for (Index k = 0; k < q; ++k) work_[k] = dot(free_.data(), Q_[k].data(), n);
    take_off(work_);
    for (Index k = 0; k < q; ++k) along_[k] += work_[k];
    free_off_square_ = kRounding;
  }
  return free_sq_ > least_share * least_share * length_sq;
}

/// Takes the columns of Q, each times its share, off what is free.
void SmallQp::take_off(const Column& shares) noexcept {
  const Index q = count();
  const Index n = whole(problem_.unknowns);
  for (Index i = 0; i < n; i += 8) {
    Eight eight(free_.data() + i);
    for (Index k = 0; k < q; ++k) eight.add(-shares[k], Q_[k].data() + i);
    eight.store(free_.data() + i);
  }
  free_sq_ = dot(free_.data(), free_.data(), n);
}

/// What the rows that hold push off with for a push along `along`.
void SmallQp::set_push() noexcept {
  Column& rest = work_;
  std::copy_n(along_.begin(), count(), rest.begin());
  for (Index j = count(); j-- > 0;) {
    push_[j] = rest[j] * diagonal_[j];
    add(-push_[j], R_[j].data(), j, rest.data());
  }
}

/// How far until a holding row would pull, and which.
double SmallQp::longest_step(Index& blocking) const noexcept {
  double longest = kFar;
  for (Index j = 0; j < count(); ++j) {
    if (push_[j] <= 0.0) continue;
    const double step = answer_.active[j].multiplier / push_[j];
    if (step < longest) {
      longest = step;
      blocking = j;
    }
  }
  return longest;
}

/// Takes in the row of the last direction.
void SmallQp::append(Index row, double multiplier) noexcept {
  const Index q = count();
  const double length = std::sqrt(free_sq_);
  Q_[q].fill(0.0);
  add(1.0 / length, free_.data(), whole(problem_.unknowns), Q_[q].data());
  std::copy_n(along_.begin(), q, R_[q].begin());
  std::fill(R_[q].begin() + static_cast<std::ptrdiff_t>(q), R_[q].end(), 0.0);
  R_[q][q] = length;
  diagonal_[q] = 1.0 / length;
  answer_.active.push_back({static_cast<int>(row), multiplier});
  off_square_ = std::max(off_square_, free_off_square_);
}

/// Takes a column out of R and makes the rest triangular again.
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
    diagonal_[j] = 1.0 / R_[j][j];
    double* const one = Q_[j].data();
    double* const other = Q_[j + 1].data();
    for (Index i = 0; i < problem_.unknowns; i += 2) {
      Lanes a = lanes(one + i);
      Lanes b = lanes(other + i);
      turn.apply(a, b);
      std::memcpy(one + i, &a, sizeof a);
      std::memcpy(other + i, &b, sizeof b);
    }
  }
}

}  // namespace tactum
