#include "tactum/dynamics/contact_solver.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "tactum/base/tolerances.h"

namespace tactum {
namespace {

using Index = std::size_t;

/// Projected Gauss-Seidel from first row to last, until a sweep changes next to nothing.
SolverResult sweep(std::span<ContactRow> rows, std::span<const PushRow> pushes, double h, int max_sweeps,
                   std::span<Twist> V) {
  SolverResult result;
  for (; result.iterations < max_sweeps; ++result.iterations) {
    double largest_target = 0.0;
    double largest_change = 0.0;
    for (Index r = 0; r < rows.size(); ++r) {
      ContactRow& row = rows[r];
      Twist& a = V[Index(row.body_a)];
      Twist& b = V[Index(row.body_b)];
      const double compliance = 1.0 / (row.stiffness * h * h);
      const double target = (row.tolerance - row.distance) / h;
      const double error = target - pushes[r].velocity(a, b) - compliance * row.impulse;
      const double impulse = std::max(0.0, row.impulse + error / (pushes[r].mobility + compliance));
      const double change = impulse - row.impulse;
      if (change == 0.0) continue;
      row.impulse = impulse;
      pushes[r].push(change, a, b);
      largest_change = std::max(largest_change, std::abs(change) * (pushes[r].mobility + compliance));
      largest_target = std::max(largest_target, std::abs(target));
    }
    result.converged = largest_change <= tolerances::kContactVelocity * largest_target;
    if (result.converged) break;
  }
  return result;
}

/// The same problem in the coordinates of motion. A body's mobility is W = B B^T; with V = V* + B z and
/// g_i = B^T J_i the impulses are  lambda_i = max(0, b_i - g_i z) / c_i,  c_i = 1 / (k h^2),  and z is the
/// least of
///
///     |z|^2 / 2 + sum_i max(0, b_i - g_i z)^2 / (2 c_i):
///
/// convex, quadratic while the same rows push. A Newton step is a Cholesky factor of I + sum g_i g_i^T / c_i
/// over those, whose size is the freedom of the bodies (a hinge 1, a free body 6), however many rows there
/// are.
class MotionProblem {
 public:
  static constexpr Index kMostRows = 128;
  static constexpr Index kMostColumns = 24;  // four free bodies

  // Not filled: set() and solve() write what is read.
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init,modernize-use-equals-default)
  MotionProblem() noexcept {}

  /// False when there are too many rows or bodies.
  bool set(std::span<const ContactRow> rows, std::span<const Pose> X_WB, std::span<const Mobility> W,
           double h, std::span<const Twist> V) {
    if (rows.size() > kMostRows) return false;
    const double per_h = 1.0 / h;
    double most_wanted = 0.0;
    for (const ContactRow& row : rows) {
      const int a = body_of(row.body_a, W);
      const int b = body_of(row.body_b, W);
      if (a < 0 || b < 0) return false;
      Row& r = rows_[n_];
      const Vec3& n = row.n_BA_W;
      const Vec3 turn_a = (row.p_W - X_WB[Index(row.body_a)].p).cross(n);
      const Vec3 turn_b = (row.p_W - X_WB[Index(row.body_b)].p).cross(n);
      r.size = 0;
      // In the order of the columns, for H is kept below its diagonal.
      if (bodies_[Index(a)].first < bodies_[Index(b)].first) {
        project(bodies_[Index(a)], n, turn_a, r);
        project(bodies_[Index(b)], -n, -turn_b, r);
      } else {
        project(bodies_[Index(b)], -n, -turn_b, r);
        project(bodies_[Index(a)], n, turn_a, r);
      }
      r.stiffness = row.stiffness * h * h;
      const Twist& V_a = V[Index(row.body_a)];
      const Twist& V_b = V[Index(row.body_b)];
      const double approach = n.dot(V_a.v - V_b.v) + turn_a.dot(V_a.w) - turn_b.dot(V_b.w);
      r.wanted = (row.tolerance - row.distance) * per_h - approach;
      r.active = false;
      most_wanted = std::max(most_wanted, std::abs(r.wanted));
      ++n_;
    }
    allowed_ = tolerances::kContactVelocity * most_wanted;
    for (Index i = 0; i < columns_; ++i) {
      right_[i] = 0.0;
      for (Index j = 0; j <= i; ++j) H_[i][j] = i == j ? 1.0 : 0.0;
    }
    return true;
  }

  /// Newton's method from the rows that approach too fast; where the same number of rows stays wrong it turns
  /// one at a time [Portugal 1994]. Returns the rounds, 0 when they ran out.
  int solve() {
    for (Index i = 0; i < n_; ++i)
      if (rows_[i].wanted > 0.0) turn(rows_[i]);
    Index fewest = n_ + 1;
    int tries = kTries;
    for (int round = 1; round <= kMostRounds; ++round) {
      newton_step();
      Index wrong = 0;
      for (Index i = 0; i < n_; ++i) {
        rows_[i].residual = residual(rows_[i]);
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
        turn(rows_[i]);
        if (tries < 0) break;
      }
    }
    return 0;
  }

  double impulse(Index i) const {
    return rows_[i].active ? std::max(0.0, rows_[i].residual) * rows_[i].stiffness : 0.0;
  }

  void add_motion(std::span<Twist> V) const {
    for (Index m = 0; m < body_count_; ++m) {
      const ColumnBody& column_body = bodies_[m];
      Vec6 change = Vec6::Zero();
      for (Index k = 0; k < column_body.rank; ++k) change += column_body.B[k] * z_[column_body.first + k];
      V[Index(column_body.body)].v += change.head<3>();
      V[Index(column_body.body)].w += change.tail<3>();
    }
  }

 private:
  static constexpr int kTries = 3;
  static constexpr int kMostRounds = 24;  // two are usual
  static constexpr Index kMostBodies = 16;

  struct ColumnBody {
    int body = -1;
    Index first = 0, rank = 0;  // its columns
    Vec6 B[6];
  };
  struct Row {
    Index size;  // of g, where it is not zero: the columns of both bodies, in order
    std::array<std::uint8_t, 12> column;
    static_assert(kMostColumns <= 256);
    std::array<double, 12> g;
    double stiffness;  // 1 / c
    double wanted;     // b
    double residual;   // b - g z, since the last step
    bool active;
  };

  /// The columns of a body, made when it is met first; -1 when there is no room.
  int body_of(int body, std::span<const Mobility> W) {
    for (Index m = 0; m < body_count_; ++m)
      if (bodies_[m].body == body) return static_cast<int>(m);
    if (body_count_ == kMostBodies) return -1;
    ColumnBody& next = bodies_[body_count_];
    next.body = body;
    next.first = columns_;
    next.rank = factor(W[Index(body)], next.B);
    if (columns_ + next.rank > kMostColumns) return -1;
    columns_ += next.rank;
    return static_cast<int>(body_count_++);
  }

  /// W = sum_k B_k B_k^T by Cholesky with the largest pivot first; a hinge has one column, what is fixed
  /// none. Of what is left of W only the diagonal is kept: each column is made when it is the pivot's.
  static Index factor(const Mobility& W, Vec6 (&B)[6]) {
    Vec6 left = W.diagonal();
    for (Index rank = 0; rank < 6; ++rank) {
      int pivot = -1;
      double most = tolerances::kNoMobility;  // of the share of the diagonal that is left
      for (int i = 0; i < 6; ++i)
        if (left[i] > most * W(i, i)) {
          most = left[i] / W(i, i);
          pivot = i;
        }
      if (pivot < 0) return rank;
      Vec6 column = W.col(pivot);
      for (Index k = 0; k < rank; ++k) column -= B[k] * B[k][pivot];
      B[rank] = column / std::sqrt(left[pivot]);
      left -= B[rank].cwiseAbs2();
    }
    return 6;
  }

  /// Adds what a push along `n`, with its turning part, is in a mover's columns.
  static void project(const ColumnBody& column_body, const Vec3& n, const Vec3& turn, Row& row) {
    for (Index k = 0; k < column_body.rank; ++k) {
      row.column[row.size] = static_cast<std::uint8_t>(column_body.first + k);
      row.g[row.size++] = column_body.B[k].head<3>().dot(n) + column_body.B[k].tail<3>().dot(turn);
    }
  }

  /// Puts a row among those that push, or takes it out.
  void turn(Row& row) {
    row.active = !row.active;
    const double weight = row.active ? row.stiffness : -row.stiffness;
    for (Index i = 0; i < row.size; ++i) {
      const double scaled = weight * row.g[i];
      right_[row.column[i]] += scaled * row.wanted;
      double* const H = H_[row.column[i]];
      for (Index j = 0; j <= i; ++j) H[row.column[j]] += scaled * row.g[j];
    }
  }

  /// z = H^-1 right.
  void newton_step() {
    for (Index i = 0; i < columns_; ++i) {
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
    for (Index i = columns_; i-- > 0;) {
      double sum = z_[i];
      for (Index k = i + 1; k < columns_; ++k) sum -= L_[k][i] * z_[k];
      z_[i] = sum * inverse_[i];
    }
  }

  /// b - g z: by how much the row still approaches too fast.
  double residual(const Row& row) const {
    double sum = row.wanted;
    for (Index i = 0; i < row.size; ++i) sum -= row.g[i] * z_[row.column[i]];
    return sum;
  }
  bool is_wrong(const Row& row) const {
    return row.active ? !(row.residual >= -allowed_) : !(row.residual <= allowed_);  // NaN is wrong
  }

  Index n_ = 0, body_count_ = 0, columns_ = 0;
  double allowed_ = 0.0;  // so much of a residual may stay [m/s]
  Row rows_[kMostRows];
  ColumnBody bodies_[kMostBodies];
  double H_[kMostColumns][kMostColumns], L_[kMostColumns][kMostColumns];
  double right_[kMostColumns], z_[kMostColumns], inverse_[kMostColumns];
};

}  // namespace

SolverResult solve_contacts(std::span<ContactRow> rows, std::span<const Pose> X_WB,
                            std::span<const Mobility> W, double h, int max_sweeps,
                            std::vector<PushRow>& pushes, std::span<Twist> V) noexcept {
  if (rows.empty()) return {.iterations = 0, .converged = true};
  MotionProblem problem;
  if (problem.set(rows, X_WB, W, h, V)) {
    if (const int rounds = problem.solve(); rounds > 0) {
      for (Index i = 0; i < rows.size(); ++i) rows[i].impulse = problem.impulse(i);
      problem.add_motion(V);
      return {.iterations = rounds, .converged = true};
    }
  }
  pushes.resize(rows.size());
  for (Index r = 0; r < rows.size(); ++r) {
    ContactRow& row = rows[r];
    const Index a = Index(row.body_a);
    const Index b = Index(row.body_b);
    pushes[r].set(row.n_BA_W, row.p_W - X_WB[a].p, row.p_W - X_WB[b].p, W[a], W[b]);
    row.impulse = 0.0;
  }
  return sweep(rows, pushes, h, max_sweeps, V);
}

}  // namespace tactum
