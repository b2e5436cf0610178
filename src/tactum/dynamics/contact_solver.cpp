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

void add(Twist& V, const Vec6& response, double impulse) {
  V.v += response.head<3>() * impulse;
  V.w += response.tail<3>() * impulse;
}

}  // namespace

void apply_hinge_friction(const World& world, const WorldState& state, std::span<const Mobility> W, double h,
                          std::span<Twist> V) noexcept {
  for (Index i = 0; i < world.bodies.size(); ++i) {
    const Joint& joint = world.bodies[i].joint;
    if (joint.kind != JointKind::kHinge || (joint.friction_Nm == 0.0 && joint.damping_Nms == 0.0)) continue;
    const double mobility_about_axis = joint.axis_W.dot(W[i].bottomRightCorner<3, 3>() * joint.axis_W);
    const double rate = joint.axis_W.dot(V[i].w);
    const double damped = rate / (1.0 + joint.damping_Nms * h * mobility_about_axis);
    const double most = joint.friction_Nm * h * mobility_about_axis;
    const double slowed = damped - std::clamp(damped, -most, most);
    V[i] = to_twist(hinge_motion(joint, state.X_WB[i]) * slowed);
  }
}

SolverResult solve_contacts(std::span<ContactRow> rows, std::span<const Pose> X_WB, std::span<const Mobility> W,
                            double h, int max_sweeps, std::span<Twist> V) noexcept {
  for (ContactRow& row : rows) prepare(row, X_WB, W);
  SolverResult result;
  for (; result.sweeps < max_sweeps; ++result.sweeps) {
    double largest_target = 0.0;
    result.residual = 0.0;
    for (ContactRow& row : rows) {
      const double compliance = 1.0 / (row.stiffness * h * h);
      const double target = (row.tolerance - row.distance) / h;
      const double error = target - normal_velocity(row, V) - compliance * row.impulse;
      const double impulse = std::max(0.0, row.impulse + error / (row.diagonal + compliance));
      const double change = impulse - row.impulse;
      if (change == 0.0) continue;
      row.impulse = impulse;
      add(V[Index(row.body_a)], row.response_a, change);
      add(V[Index(row.body_b)], row.response_b, change);
      result.residual = std::max(result.residual, std::abs(change) * (row.diagonal + compliance));
      largest_target = std::max(largest_target, std::abs(target));
    }
    if (result.residual <= tolerances::kContactVelocity * largest_target) break;
  }
  return result;
}

}  // namespace tactum
