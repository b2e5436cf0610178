#include "tactum/math/small_qp.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tactum/base/tolerances.h"

namespace tactum {
namespace {

using Index = std::size_t;
constexpr double kFar = std::numeric_limits<double>::infinity();

/// A row of which less than this share is left beside those begun with waits until it is broken: taken as an
/// equation, what rows all but agree on would be solved for with forces that are as many times too large.
constexpr double kWorthBeginning = 1e-3;

void add(double times, const double* x, Index n, double* to) noexcept {
  for (Index i = 0; i < n; ++i) to[i] += times * x[i];
}

double squared_norm(const double* x, Index n) noexcept {
  double sum = 0.0;
  for (Index i = 0; i < n; ++i) sum += x[i] * x[i];
  return sum;
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
  void apply(double& a, double& b) const noexcept {
    const double turned = cosine * a + sine * b;
    b = cosine * b - sine * a;
    a = turned;
  }
};

}  // namespace

void SmallQp::begin(const QpProblem& problem, std::span<const int> first) noexcept {
  problem_ = problem;
  n_ = problem.unknowns;
  answer_.active.clear();
  std::fill_n(Q_.begin(), n_ * n_, 0.0);
  for (Index k = 0; k < n_; ++k) orthogonal(k)[k] = 1.0;
  for (const int row : first)
    if (count() < n_ && set_direction(problem.rows[Index(row)], kWorthBeginning)) append(Index(row), 0.0);
}

const QpAnswer& SmallQp::solve_on(const QpProblem& problem, int max_iterations) noexcept {
  problem_ = problem;
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
    double* const y = work_.data();  // z = Q1 y
    for (Index j = 0; j < q; ++j) {
      double rest = problem_.rows[Index(answer_.active[j].row)].offset;
      for (Index k = 0; k < j; ++k) rest -= triangular(k, j) * y[k];
      y[j] = rest / triangular(j, j);
    }
    Index pulling = q;
    double most = 0.0;
    for (Index j = q; j-- > 0;) {
      double rest = y[j];
      for (Index k = j + 1; k < q; ++k) rest -= triangular(j, k) * answer_.active[k].multiplier;
      answer_.active[j].multiplier = rest / triangular(j, j);
      if (answer_.active[j].multiplier < most) {
        most = answer_.active[j].multiplier;
        pulling = j;
      }
    }
    if (pulling < q) {
      ++answer_.iterations;
      release(pulling);
      continue;
    }
    answer_.z.fill(0.0);
    for (Index k = 0; k < q; ++k) add(y[k], orthogonal(k), n_, answer_.z.data());
    return;
  }
}

/// How far the answer is from keeping a row.
double SmallQp::missing(const QpRow& row) const noexcept {
  double sums[2] = {};
  for (Index r = 0; r < 2; ++r) {
    const QpRow::Run& run = row.runs[r];
    for (Index i = 0; i < run.count; ++i) sums[r] += run.g[i] * answer_.z[run.first + i];
  }
  return row.offset - (sums[0] + sums[1]);
}

/// The row that is missed by most, if any is by more than the slack.
bool SmallQp::most_broken(Index& worst) const noexcept {
  double most = problem_.slack;
  bool broken = false;
  for (Index row = 0; row < problem_.rows.size(); ++row) {
    const double by = missing(problem_.rows[row]);
    if (!(by > most)) continue;
    most = by;
    worst = row;
    broken = true;
  }
  return broken;
}

/// Walks until `row` is kept.
QpStatus SmallQp::take(Index index, int max_iterations) noexcept {
  const QpRow& row = problem_.rows[index];
  double multiplier = 0.0;
  while (answer_.iterations < max_iterations) {
    ++answer_.iterations;
    const bool dependent = !set_direction(row, tolerances::kDependentRow);
    set_push();
    const double whole = dependent ? kFar : missing(row) / free_sq_;
    Index blocking = 0;
    const double allowed = longest_step(blocking);
    // No row lets go: there is no way, or the numbers are none (a scene that was set absurdly).
    if (allowed == kFar && (dependent || !(whole < kFar))) return QpStatus::kInfeasible;
    const double step = whole <= allowed ? whole : allowed;
    for (Index j = 0; j < count(); ++j) answer_.active[j].multiplier -= step * push_[j];
    multiplier += step;
    if (!dependent)
      for (Index k = count(); k < n_; ++k) add(step * d_[k], orthogonal(k), n_, answer_.z.data());
    if (whole <= allowed) {
      append(index, multiplier);
      return QpStatus::kSolved;
    }
    release(blocking);
  }
  return QpStatus::kBounded;
}

/// d = Q^T g; what of it no holding row sees is the way to go. False when that is no more than such a share.
bool SmallQp::set_direction(const QpRow& row, double least_share) noexcept {
  std::fill_n(d_.begin(), n_, 0.0);
  double length_sq = 0.0;
  for (const QpRow::Run& run : row.runs) {
    for (Index k = 0; k < n_; ++k) {
      double sum = 0.0;
      for (Index i = 0; i < run.count; ++i) sum += orthogonal(k)[run.first + i] * run.g[i];
      d_[k] += sum;
    }
    length_sq += squared_norm(run.g.data(), run.count);
  }
  const Index q = count();
  free_sq_ = squared_norm(d_.data() + q, n_ - q);
  return free_sq_ > least_share * least_share * length_sq;
}

/// The rest of d is pushed off from the rows that hold.
void SmallQp::set_push() noexcept {
  const Index q = count();
  for (Index j = q; j-- > 0;) {
    double rest = d_[j];
    for (Index k = j + 1; k < q; ++k) rest -= triangular(j, k) * push_[k];
    push_[j] = rest / triangular(j, j);
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

/// Mirrors the free part of d onto the first free column of Q, which with d is the new last column of Q1 and
/// R.
void SmallQp::append(Index row, double multiplier) noexcept {
  const Index q = count();
  const double along = d_[q] > 0.0 ? -std::sqrt(free_sq_) : std::sqrt(free_sq_);
  d_[q] -= along;  // d is the mirror's normal from here on
  if (const double length_sq = squared_norm(d_.data() + q, n_ - q); length_sq > 0.0) {
    double* const seen = work_.data();
    std::fill_n(seen, n_, 0.0);
    for (Index k = q; k < n_; ++k) add(d_[k], orthogonal(k), n_, seen);
    for (Index k = q; k < n_; ++k) add(-2.0 * d_[k] / length_sq, seen, n_, orthogonal(k));
  }
  for (Index k = 0; k < q; ++k) triangular(k, q) = d_[k];
  triangular(q, q) = along;
  answer_.active.push_back({static_cast<int>(row), multiplier});
}

/// Takes a column out of R and makes the rest triangular again.
void SmallQp::release(Index leaving) noexcept {
  const Index q = count();
  for (Index j = leaving; j + 1 < q; ++j) {
    answer_.active[j] = answer_.active[j + 1];
    for (Index k = 0; k <= j + 1; ++k) triangular(k, j) = triangular(k, j + 1);
  }
  answer_.active.pop_back();
  for (Index j = leaving; j + 1 < q; ++j) {
    const Turn turn(triangular(j, j), triangular(j + 1, j));
    for (Index k = j; k + 1 < q; ++k) turn.apply(triangular(j, k), triangular(j + 1, k));
    for (Index i = 0; i < n_; ++i) turn.apply(orthogonal(j)[i], orthogonal(j + 1)[i]);
  }
}

}  // namespace tactum
