#include "tactum/dynamics/even_loads.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <limits>

#include "tactum/base/tolerances.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;
constexpr int kSize = static_cast<int>(kMostUnknowns);
using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kSize, kSize>;
using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kSize, 1>;

/// Corners that would be pulled are left out, in so many rounds at most.
constexpr int kRounds = 8;
/// Effects differ by no more than this fraction of their size; forces below this fraction of the largest are
/// none.
constexpr double kSameEffect = tolerances::kSameFriction;
/// What is added to the matrix, as a fraction of its trace: several corners have dependent rows.
constexpr double kRidge = 1e4 * std::numeric_limits<double>::epsilon();

/// Adds g g^T to the matrix.
void add_square(const QpRow& row, Matrix& to) {
  for (const QpRow::Run& p : row.runs)
    for (Index i = 0; i < p.count; ++i)
      for (const QpRow::Run& q : row.runs)
        for (Index j = 0; j < q.count; ++j)
          to(static_cast<int>(p.first + i), static_cast<int>(q.first + j)) += p.g[i] * q.g[j];
}

double product(const QpRow& row, const Vector& with) {
  double sum = 0.0;
  for (const QpRow::Run& run : row.runs)
    for (Index i = 0; i < run.count; ++i) sum += run.g[i] * with[static_cast<int>(run.first + i)];
  return sum;
}

/// Lists the corners that touch in the last answer; false when there is no room for them.
bool list_touching(const RowsInProblem& contacts, const ContactProblem& problem, EvenLoads& loads) {
  for (Index i = 0; i < contacts.rows.size(); ++i) {
    const ContactRow& row = contacts.rows[i];
    const bool touches =
        problem.opening(problem.row_list()[contacts.first + i]) <= settled_length(row.skin_m);
    if (touches && !loads.rows.push_back(static_cast<int>(i))) return false;
  }
  return true;
}

}  // namespace

bool find_even_loads(const RowsInProblem& contacts, const ContactProblem& problem,
                     const UnknownChange& beside, EvenLoads& loads) noexcept {
  loads.rows.clear();
  const auto row_of = [&](Index i) -> const QpRow& {
    return problem.row_list()[contacts.first + Index(loads.rows[i])];
  };
  const auto take_answer = [&] {
    loads.rows.clear();
    for (const QpActive& active : problem.answer().active) {
      if (contacts.row(active.row) == nullptr) continue;
      loads.force_N[loads.rows.size()] = active.multiplier;
      loads.rows.push_back(active.row - static_cast<int>(contacts.first));
    }
    return false;
  };
  if (!list_touching(contacts, problem, loads)) return take_answer();
  const int unknowns = static_cast<int>(problem.unknowns());
  Vector effect = Eigen::Map<const Vector>(beside.data(), unknowns);
  for (const QpActive& active : problem.answer().active)
    if (contacts.row(active.row) != nullptr)
      push(problem.row_list()[Index(active.row)], active.multiplier, effect.data());
  std::array<bool, EvenLoads::kMost> carries{};
  std::fill_n(carries.begin(), loads.rows.size(), true);
  Vector missing = effect;
  double largest = 0.0;
  for (int round = 0; round < kRounds; ++round) {
    Matrix square = Matrix::Zero(unknowns, unknowns);
    for (Index i = 0; i < loads.rows.size(); ++i)
      if (carries[i]) add_square(row_of(i), square);
    square.diagonal().array() += kRidge * square.trace();
    const Vector y = square.ldlt().solve(effect);
    bool pulled = false;
    missing = effect;
    largest = 0.0;
    for (Index i = 0; i < loads.rows.size(); ++i) {
      double force = carries[i] ? product(row_of(i), y) : 0.0;
      if (force < 0.0) {
        carries[i] = false;
        pulled = true;
        force = 0.0;
      }
      push(row_of(i), -force, missing.data());
      largest = std::max(largest, force);
      loads.force_N[i] = force;
    }
    if (!pulled) break;
  }
  if (!(missing.norm() <= kSameEffect * effect.norm())) return take_answer();
  for (Index i = 0; i < loads.rows.size(); ++i)
    if (loads.force_N[i] < kSameEffect * largest) loads.force_N[i] = 0.0;
  return true;
}

}  // namespace tactum::inline v0_1
