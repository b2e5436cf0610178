#include "tactum/response/coupling.h"

namespace tactum::inline v0_1 {

Wrench coupling_wrench(const Coupling& coupling, const Twist& to_hand, const Twist& V_WH,
                       const Twist& V_WH_proxy) noexcept {
  const Twist rate = V_WH_proxy - V_WH;
  return {coupling.damping_Ns_per_m * rate.v - coupling.stiffness_N_per_m * to_hand.v,
          coupling.damping_Nms_per_rad * rate.w - coupling.stiffness_Nm_per_rad * to_hand.w};
}

GraspMetric grasp_metric(const Coupling& coupling, double dt_s) noexcept {
  return {coupling.stiffness_N_per_m + coupling.damping_Ns_per_m / dt_s,
          coupling.stiffness_Nm_per_rad + coupling.damping_Nms_per_rad / dt_s};
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
