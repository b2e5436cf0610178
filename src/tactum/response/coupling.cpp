#include "tactum/response/coupling.h"

#include <Eigen/LU>
#include <algorithm>

namespace tactum::inline v0_1 {
namespace {

/// The fraction of the coupling's stiffness that is left about the axis of a rod, because a metric must be
/// positive. It shortens the steps to where the force of the coupling turns the body, and changes nothing of
/// where they end.
constexpr double kRodStiffness = 1e-3;

}  // namespace

Wrench coupling_wrench(const Coupling& coupling, const GraspedPart& grasped, const Twist& to_hand,
                       const Twist& rate) noexcept {
  return {
      coupling.damping_Ns_per_m * rate.v - coupling.stiffness_N_per_m * to_hand.v,
      coupling.damping_Nms_per_rad * passed_on(grasped, rate.w) - coupling.stiffness_Nm_per_rad * to_hand.w};
}

GraspMetric grasp_metric(const Coupling& coupling, double dt_s) noexcept {
  return {coupling.stiffness_N_per_m + coupling.damping_Ns_per_m / dt_s,
          coupling.stiffness_Nm_per_rad + coupling.damping_Nms_per_rad / dt_s};
}

GraspedBody grasped_body_of(const BodyLoad& load, const GraspedPart& grasped, const Pose& X_WB,
                            const GraspMetric& metric, const Vec6& target, double dt_s) noexcept {
  const Vec3 handle = X_WB * grasped.X_BH.p;
  GraspedBody as_body{handle, body_metric(metric), target};
  if (!load.damps() && grasped.hold != Hold::kRod) return as_body;
  const double k = metric.stiffness_N_per_m;
  const double k_turning = metric.stiffness_Nm_per_rad;
  const double drag = load.damping_Ns_per_m / dt_s;
  const Vec3 arm = X_WB.p - handle;
  const Vec3 shift = drag / (k + drag) * arm;
  as_body.centre_W = handle + shift;
  as_body.metric.linear = k + drag;
  as_body.metric.angular +=
      load.damping_Nms_per_rad / dt_s * Mat3::Identity() +
      k * drag / (k + drag) * (arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose());
  // A spring that pulls a rod outwards holds it the harder the farther it is stretched: without that a hand
  // twice as far out as the rod would be overshot in every step.
  const double pulled_out = std::max(0.0, k * grasped.arm_W.dot(target.head<3>()));
  as_body.metric.angular +=
      (pulled_out - (1.0 - kRodStiffness) * k_turning) * grasped.axis_W * grasped.axis_W.transpose();
  const Vec3 force = k * target.head<3>();
  const Vec3 torque = k_turning * target.tail<3>() - shift.cross(force);
  as_body.target << force / as_body.metric.linear, as_body.metric.angular.inverse() * torque;
  return as_body;
}

GraspedBody grasped_by_both(const GraspedBody& one, const GraspedBody& other) noexcept {
  GraspedBody both;
  const double linear = one.metric.linear + other.metric.linear;
  both.metric.linear = linear;
  both.centre_W = (one.metric.linear * one.centre_W + other.metric.linear * other.centre_W) / linear;
  Vec3 force = Vec3::Zero();
  Vec3 torque = Vec3::Zero();
  for (const GraspedBody* each : {&one, &other}) {
    const double k = each->metric.linear;
    const Vec3 arm = each->centre_W - both.centre_W;
    both.metric.angular +=
        each->metric.angular + k * (arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose());
    const Vec3 pull = k * each->target.head<3>();
    force += pull;
    torque += each->metric.angular * each->target.tail<3>() + arm.cross(pull);
  }
  both.target << force / linear, both.metric.angular.inverse() * torque;
  return both;
}

Vec6 balanced_step(const Coupling& coupling, double dt_s, const Twist& to_hand, const Twist& V_WH) noexcept {
  // k (x - d) + b (x / dt - v) = 0, with d the displacement to the hand.
  const GraspMetric metric = grasp_metric(coupling, dt_s);
  Vec6 x;
  x.head<3>() = (coupling.stiffness_N_per_m * to_hand.v + coupling.damping_Ns_per_m * V_WH.v) /
                metric.stiffness_N_per_m;
  x.tail<3>() = (coupling.stiffness_Nm_per_rad * to_hand.w + coupling.damping_Nms_per_rad * V_WH.w) /
                metric.stiffness_Nm_per_rad;
  return x;
}

}  // namespace tactum::inline v0_1
