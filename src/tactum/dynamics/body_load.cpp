#include "tactum/dynamics/body_load.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "tactum/math/screw.h"

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;

/// Below this the share is stated by its series, whose error is then below rounding.
constexpr double kShortStep = 1e-2;

/// The share of the damping that acts on the velocity at the end of a step in which speeds fade by e^-x: a
/// half for a short step, all for a long one. That of a step back is what is left of it.
double share_at_end(double x) noexcept {
  if (std::abs(x) < kShortStep) return 0.5 + x / 12.0 * (1.0 - x * x / 60.0);
  return -1.0 / std::expm1(-x) - 1.0 / x;
}

/// Inertia about the centre of mass, axes of W.
Mat3 inertia_W(const Body& body, const Pose& X_WB) noexcept {
  return X_WB.R * body.inertia_B * X_WB.R.transpose();
}

double largest_row_sum(const Mat3& A) noexcept { return A.cwiseAbs().rowwise().sum().maxCoeff(); }

/// Rates of fading of the motions along a line and of turns, which differ for a free body only [1/s].
struct Fading {
  double linear = 0.0, turning = 0.0;
};

Fading fading_of(const Body& body, const Pose& X_WB) noexcept {
  const double c = body.load.damping_Ns_per_m;
  const double c_turning = body.load.damping_Nms_per_rad;
  if (body.joint.kind == JointKind::kFree)
    return {c / body.mass_kg, c_turning * largest_row_sum(inertia_W(body, X_WB).inverse())};
  const JointMotions S = joint_motions(body.joint, X_WB);
  if (S.cols() == 0) return {};
  const JointMotions MS = inertial_resistance(body, X_WB) * S;
  JointMotions DS = S;
  DS.topRows<3>() *= c;
  DS.bottomRows<3>() *= c_turning;
  double rate = 0.0;
  if (S.cols() == 1) {
    rate = S.col(0).dot(DS.col(0)) / S.col(0).dot(MS.col(0));
  } else {
    const Mat3 M = S.transpose() * MS;
    const Mat3 D = S.transpose() * DS;
    rate = largest_row_sum(M.inverse() * D);
  }
  return {rate, rate};
}

/// What damping adds to mass and inertia over a step.
struct Added {
  double mass_kg = 0.0, inertia_kg_m2 = 0.0;
};

Added added_by_damping(const Body& body, const Pose& X_WB, double h) noexcept {
  if (!body.load.damps()) return {};
  const Fading fading = fading_of(body, X_WB);
  return {share_at_end(fading.linear * h) * h * body.load.damping_Ns_per_m,
          share_at_end(fading.turning * h) * h * body.load.damping_Nms_per_rad};
}

}  // namespace

double fastest_fading(const Body& body, const Pose& X_WB) noexcept {
  const Fading fading = fading_of(body, X_WB);
  return std::max(fading.linear, fading.turning);
}

Resistance damped_resistance(const Body& body, const Pose& X_WB, double h) noexcept {
  const Added added = added_by_damping(body, X_WB, h);
  Resistance M = inertial_resistance(body, X_WB);
  M.diagonal().head<3>().array() += added.mass_kg;
  M.diagonal().tail<3>().array() += added.inertia_kg_m2;
  return M;
}

BodyMetric damped_metric(const Body& body, const Pose& X_WB, double h) noexcept {
  BodyMetric metric = inertial_metric(body, X_WB, h);
  if (!body.load.damps()) return metric;
  const Added added = added_by_damping(body, X_WB, h);
  metric.linear += added.mass_kg / (h * h);
  metric.angular.diagonal().array() += added.inertia_kg_m2 / (h * h);
  return metric;
}

Twist driven_velocity(const Body& body, const Vec3& gravity_W, const Pose& X_WB, const Twist& V_WB,
                      double h) noexcept {
  const BodyLoad& load = body.load;
  if (!load.acts()) return {V_WB.v + gravity_W * h, V_WB.w};
  const Added added = added_by_damping(body, X_WB, h);
  const Vec3 force = body.mass_kg * gravity_W + load.constant.f - load.damping_Ns_per_m * V_WB.v;
  const Vec3 torque = load.constant.t - load.damping_Nms_per_rad * V_WB.w;
  const Mat3 inertia = inertia_W(body, X_WB) + added.inertia_kg_m2 * Mat3::Identity();
  return {V_WB.v + h / (body.mass_kg + added.mass_kg) * force, V_WB.w + inertia.inverse() * (h * torque)};
}

Twist most_by_load(const Body& body, const Pose& X_WB, double h) noexcept {
  if (!body.load.acts()) return {};
  const Wrench& constant = body.load.constant;
  const Twist change{h / body.mass_kg * constant.f, inertia_W(body, X_WB).inverse() * (h * constant.t)};
  return constrained_velocity(body.joint, X_WB, inertial_resistance(body, X_WB), change);
}

double work_of_loads(const World& world, std::span<const Pose> from, std::span<const Pose> to,
                     double h) noexcept {
  double work_J = 0.0;
  for (Index i = 0; i < world.bodies.size(); ++i) {
    const BodyLoad& load = world.bodies[i].load;
    if (!load.acts()) continue;
    const Twist moved = twist_between(from[i], to[i], 1.0);
    work_J += (load.constant.f - load.damping_Ns_per_m / h * moved.v).dot(moved.v) +
              (load.constant.t - load.damping_Nms_per_rad / h * moved.w).dot(moved.w);
  }
  return work_J;
}

}  // namespace tactum::inline v0_1
