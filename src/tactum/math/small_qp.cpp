#include "tactum/math/small_qp.h"

#include <cmath>
#include <limits>

#include "tactum/base/tolerances.h"

namespace tactum {
namespace {

using Index = std::size_t;

double dot(const double* a, const double* b, Index n) noexcept {
  double sum = 0.0;
  for (Index i = 0; i < n; ++i) sum += a[i] * b[i];
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

/// The rows that hold: their normals are N = Q1 R, with Q = [Q1 Q2] orthogonal and R upper triangular.
/// `Most` unknowns there is room for.
template <Index Most>
class Solver {
 public:
  Solver(const QpProblem& problem, QpAnswer& answer) noexcept
      : problem_(problem), answer_(answer), n_(problem.unknowns) {
    for (Index k = 0; k < n_; ++k) Q_[k][k] = 1.0;
  }

  double missing(Index row) const noexcept {
    return problem_.offsets[row] - dot(normal(row), answer_.z.data(), n_);
  }

  /// Walks until `row` is kept.
  QpStatus take(Index row, int max_iterations) noexcept {
    const double* g = normal(row);
    const double length_sq = dot(g, g, n_);
    double multiplier = 0.0;
    while (answer_.iterations < max_iterations) {
      ++answer_.iterations;
      set_direction(g);
      const bool dependent = free_sq_ <= tolerances::kDependentRow * tolerances::kDependentRow * length_sq;
      const double whole = dependent ? kFar : missing(row) / free_sq_;
      Index blocking = 0;
      const double allowed = longest_step(blocking);
      // No row lets go: there is no way, or the numbers are none (a scene that was set absurdly).
      if (allowed == kFar && (dependent || !(whole < kFar))) return QpStatus::kInfeasible;
      const double step = whole <= allowed ? whole : allowed;
      for (Index j = 0; j < count(); ++j) answer_.active[j].multiplier -= step * push_[j];
      multiplier += step;
      if (!dependent)
        for (Index k = count(); k < n_; ++k)
          for (Index i = 0; i < n_; ++i) answer_.z[i] += step * d_[k] * Q_[k][i];
      if (whole <= allowed) {
        append(row, multiplier);
        return QpStatus::kSolved;
      }
      release(blocking);
    }
    return QpStatus::kBounded;
  }

 private:
  static constexpr double kFar = std::numeric_limits<double>::infinity();

  const double* normal(Index row) const noexcept { return problem_.normals.data() + row * n_; }
  Index count() const noexcept { return answer_.active.size(); }

  /// d = Q^T g; what of it no holding row sees is the way to go, the rest is pushed off from those rows.
  void set_direction(const double* g) noexcept {
    const Index q = count();
    for (Index k = 0; k < n_; ++k) d_[k] = dot(Q_[k], g, n_);
    free_sq_ = dot(d_ + q, d_ + q, n_ - q);
    for (Index j = q; j-- > 0;) {
      double rest = d_[j];
      for (Index k = j + 1; k < q; ++k) rest -= R_[j][k] * push_[k];
      push_[j] = rest / R_[j][j];
    }
  }

  /// How far until a holding row would pull, and which.
  double longest_step(Index& blocking) const noexcept {
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

  /// Turns the free part of d onto one column of Q, which with d is the new last column of Q1 and R.
  void append(Index row, double multiplier) noexcept {
    const Index q = count();
    for (Index k = n_ - 1; k > q; --k) {
      const Turn turn(d_[k - 1], d_[k]);
      turn.apply(d_[k - 1], d_[k]);
      for (Index i = 0; i < n_; ++i) turn.apply(Q_[k - 1][i], Q_[k][i]);
    }
    for (Index k = 0; k <= q; ++k) R_[k][q] = d_[k];
    answer_.active.push_back({static_cast<int>(row), multiplier});
  }

  /// Takes a column out of R and makes the rest triangular again.
  void release(Index leaving) noexcept {
    const Index q = count();
    for (Index j = leaving; j + 1 < q; ++j) {
      answer_.active[j] = answer_.active[j + 1];
      for (Index k = 0; k <= j + 1; ++k) R_[k][j] = R_[k][j + 1];
    }
    answer_.active.pop_back();
    for (Index j = leaving; j + 1 < q; ++j) {
      const Turn turn(R_[j][j], R_[j + 1][j]);
      for (Index k = j; k + 1 < q; ++k) turn.apply(R_[j][k], R_[j + 1][k]);
      for (Index i = 0; i < n_; ++i) turn.apply(Q_[j][i], Q_[j + 1][i]);
    }
  }

  const QpProblem& problem_;
  QpAnswer& answer_;
  const Index n_;
  double Q_[Most][Most] = {};  // column by column
  double R_[Most][Most] = {};
  double d_[Most] = {};
  double push_[Most] = {};
  double free_sq_ = 0.0;
};

template <Index Most>
QpStatus solve(const QpProblem& problem, std::span<const int> first, int max_iterations,
               QpAnswer& answer) noexcept {
  Solver<Most> solver(problem, answer);
  for (int row : first) {
    if (solver.missing(Index(row)) <= problem.slack) continue;
    const QpStatus status = solver.take(Index(row), max_iterations);
    if (status != QpStatus::kSolved) return status;
  }
  for (;;) {
    double most = problem.slack;
    Index worst = problem.offsets.size();
    for (Index row = 0; row < problem.offsets.size(); ++row) {
      const double by = solver.missing(row);
      if (by > most) {
        most = by;
        worst = row;
      }
    }
    if (worst == problem.offsets.size()) return QpStatus::kSolved;
    const QpStatus status = solver.take(worst, max_iterations);
    if (status != QpStatus::kSolved) return status;
  }
}

}  // namespace

void solve_small_qp(const QpProblem& problem, std::span<const int> first, int max_iterations,
                    QpAnswer& answer) noexcept {
  constexpr Index kOneBody = 6;
  answer.iterations = 0;
  answer.z.fill(0.0);
  answer.active.clear();
  answer.status = problem.unknowns <= kOneBody ? solve<kOneBody>(problem, first, max_iterations, answer)
                                               : solve<kMostUnknowns>(problem, first, max_iterations, answer);
}

}  // namespace tactum
