#include "tactum/dynamics/contact_solver.h"

#include <algorithm>
#include <cmath>

#include "tactum/base/tolerances.h"

namespace tactum {
namespace {

using Index = std::size_t;

Vec6 jacobian(const Vec3& n, const Vec3& r) {
  Vec6 J;
  J << n, r.cross(n);
  return J;
}

void prepare(ContactRow& row, std::span<const Pose> X_WB, std::span<const Mobility> W) {
  const Index a = Index(row.body_a);
  const Index b = Index(row.body_b);
  row.jacobian_a = jacobian(row.n_BA_W, row.p_W - X_WB[a].p);
  row.jacobian_b = -jacobian(row.n_BA_W, row.p_W - X_WB[b].p);
  row.response_a = W[a] * row.jacobian_a;
  row.response_b = W[b] * row.jacobian_b;
  row.diagonal = row.jacobian_a.dot(row.response_a) + row.jacobian_b.dot(row.response_b);
  row.impulse = 0.0;
}

double normal_velocity(const ContactRow& row, std::span<const Twist> V) {
  const Twist& a = V[Index(row.body_a)];
  const Twist& b = V[Index(row.body_b)];
  return row.jacobian_a.head<3>().dot(a.v) + row.jacobian_a.tail<3>().dot(a.w) +
         row.jacobian_b.head<3>().dot(b.v) + row.jacobian_b.tail<3>().dot(b.w);
}

void add_impulse(const ContactRow& row, double impulse, std::span<Twist> V) {
  Twist& a = V[Index(row.body_a)];
  Twist& b = V[Index(row.body_b)];
  a.v += row.response_a.head<3>() * impulse;
  a.w += row.response_a.tail<3>() * impulse;
  b.v += row.response_b.head<3>() * impulse;
  b.w += row.response_b.tail<3>() * impulse;
}

/// Projected Gauss-Seidel from first row to last, until a sweep changes next to nothing.
SolverResult sweep(std::span<ContactRow> rows, double h, int max_sweeps, std::span<Twist> V) {
  SolverResult result;
  for (; result.iterations < max_sweeps; ++result.iterations) {
    double largest_target = 0.0;
    double largest_change = 0.0;
    for (ContactRow& row : rows) {
      const double compliance = 1.0 / (row.stiffness * h * h);
      const double target = (row.tolerance - row.distance) / h;
      const double error = target - normal_velocity(row, V) - compliance * row.impulse;
      const double impulse = std::max(0.0, row.impulse + error / (row.diagonal + compliance));
      const double change = impulse - row.impulse;
      if (change == 0.0) continue;
      row.impulse = impulse;
      add_impulse(row, change, V);
      largest_change = std::max(largest_change, std::abs(change) * (row.diagonal + compliance));
      largest_target = std::max(largest_target, std::abs(target));
    }
    result.converged = largest_change <= tolerances::kContactVelocity * largest_target;
    if (result.converged) break;
  }
  return result;
}

/// The same problem as  0 <= lambda  _|_  A lambda - b >= 0  with A dense, for a few rows.
class DenseProblem {
 public:
  static constexpr Index kMostRows = 48;

  DenseProblem(std::span<const ContactRow> rows, double h, std::span<const Twist> V) : n_(rows.size()) {
    for (Index i = 0; i < n_; ++i) {
      const ContactRow& row = rows[i];
      for (Index j = 0; j <= i; ++j) A_[i][j] = A_[j][i] = coupled(row, rows[j]);
      A_[i][i] += 1.0 / (row.stiffness * h * h);
      b_[i] = (row.tolerance - row.distance) / h - normal_velocity(row, V);
      active_[i] = b_[i] > 0.0;
      scale_ = std::max(scale_, std::abs(b_[i]));
    }
  }

  /// Block principal pivoting [Portugal 1994]: solve for the active rows, swap all that came out with the
  /// wrong sign, and when that stops making progress one at a time. Returns the rounds, 0 when they ran out.
  int solve() {
    Index fewest = n_ + 1;
    int tries = kTries;
    for (int round = 1; round <= kMostRounds; ++round) {
      solve_active();
      const Index wrong = count_wrong();
      if (wrong == 0) return round;
      if (wrong < fewest) {
        fewest = wrong;
        tries = kTries;
      } else {
        --tries;
      }
      for (Index i = n_; i-- > 0;) {
        if (!is_wrong(i)) continue;
        active_[i] = !active_[i];
        if (tries < 0) break;
      }
    }
    return 0;
  }
  double impulse(Index i) const { return active_[i] ? x_[i] : 0.0; }

 private:
  static constexpr int kTries = 3;
  static constexpr int kMostRounds = 24;  // two to four are usual

  /// Normal velocity at row `a` per unit impulse at row `b`.
  static double coupled(const ContactRow& a, const ContactRow& b) {
    double sum = 0.0;
    if (a.body_a == b.body_a) sum += a.jacobian_a.dot(b.response_a);
    if (a.body_a == b.body_b) sum += a.jacobian_a.dot(b.response_b);
    if (a.body_b == b.body_a) sum += a.jacobian_b.dot(b.response_a);
    if (a.body_b == b.body_b) sum += a.jacobian_b.dot(b.response_b);
    return sum;
  }

  /// x: impulses of the active rows (by Cholesky), and A x - b of the others.
  void solve_active() {
    Index m = 0;
    for (Index i = 0; i < n_; ++i)
      if (active_[i]) row_[m++] = i;
    for (Index i = 0; i < m; ++i) {
      double y = b_[row_[i]];
      for (Index j = 0; j <= i; ++j) {
        double sum = A_[row_[i]][row_[j]];
        for (Index k = 0; k < j; ++k) sum -= L_[i][k] * L_[j][k];
        L_[i][j] = i == j ? std::sqrt(sum)
                          : sum / L_[j][j];  // A is positive definite: the compliance is on its diagonal
      }
      for (Index k = 0; k < i; ++k) y -= L_[i][k] * y_[k];
      y_[i] = y / L_[i][i];
    }
    for (Index i = m; i-- > 0;) {
      double sum = y_[i];
      for (Index k = i + 1; k < m; ++k) sum -= L_[k][i] * x_[row_[k]];
      x_[row_[i]] = sum / L_[i][i];
    }
    for (Index i = 0; i < n_; ++i) {
      if (active_[i]) continue;
      x_[i] = -b_[i];
      for (Index k = 0; k < m; ++k) x_[i] += A_[i][row_[k]] * x_[row_[k]];
    }
  }
  bool is_wrong(Index i) const {
    return active_[i] ? !(x_[i] >= 0.0) : !(x_[i] >= -tolerances::kContactVelocity * scale_);  // NaN is wrong
  }
  Index count_wrong() const {
    Index wrong = 0;
    for (Index i = 0; i < n_; ++i) wrong += is_wrong(i) ? 1 : 0;
    return wrong;
  }

  Index n_;
  double scale_ = 0.0;
  double A_[kMostRows][kMostRows], L_[kMostRows][kMostRows];
  double b_[kMostRows], x_[kMostRows], y_[kMostRows];
  Index row_[kMostRows];
  bool active_[kMostRows];
};

}  // namespace

Twist after_hinge_friction(const Joint& joint, const Pose& X_WB, const Mobility& W, double h,
                           const Twist& V) noexcept {
  if (joint.kind != JointKind::kHinge || (joint.friction_Nm == 0.0 && joint.damping_Nms == 0.0)) return V;
  const double mobility_about_axis = joint.axis_W.dot(W.bottomRightCorner<3, 3>() * joint.axis_W);
  const double rate = joint.axis_W.dot(V.w);
  const double damped = rate / (1.0 + joint.damping_Nms * h * mobility_about_axis);
  const double most = joint.friction_Nm * h * mobility_about_axis;
  return to_twist(hinge_motion(joint, X_WB) * (damped - std::clamp(damped, -most, most)));
}

SolverResult solve_contacts(std::span<ContactRow> rows, std::span<const Pose> X_WB,
                            std::span<const Mobility> W, double h, int max_sweeps,
                            std::span<Twist> V) noexcept {
  for (ContactRow& row : rows) prepare(row, X_WB, W);
  if (rows.empty()) return {.iterations = 0, .converged = true};
  if (rows.size() <= DenseProblem::kMostRows) {
    DenseProblem problem(rows, h, V);
    if (const int rounds = problem.solve(); rounds > 0) {
      for (Index i = 0; i < rows.size(); ++i) {
        rows[i].impulse = problem.impulse(i);
        if (rows[i].impulse > 0.0) add_impulse(rows[i], rows[i].impulse, V);
      }
      return {.iterations = rounds, .converged = true};
    }
  }
  return sweep(rows, h, max_sweeps, V);
}

}  // namespace tactum
