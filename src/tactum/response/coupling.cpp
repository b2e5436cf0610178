#include "tactum/response/coupling.h"

#include "tactum/math/screw.h"

namespace tactum {

Wrench coupling_wrench(const Coupling& coupling, const Pose& X_WH, const Twist& V_WH, const Pose& X_WH_proxy,
                       const Twist& V_WH_proxy) noexcept {
  const Twist stretch = twist_between(X_WH, X_WH_proxy, 1.0);  // as a displacement
  const Twist rate = V_WH_proxy - V_WH;
  return {coupling.stiffness_N_per_m * stretch.v + coupling.damping_Ns_per_m * rate.v,
          coupling.stiffness_Nm_per_rad * stretch.w + coupling.damping_Nms_per_rad * rate.w};
}

Resistance coupling_resistance(const Coupling& coupling, const Vec3& r_BH_W, double h) noexcept {
  // The handle moves with v + w x r = v - [r] w; energy  k_t |v - [r] w|^2 + k_r |w|^2.
  const Mat3 S = skew(r_BH_W);
  const double k_t = coupling.stiffness_N_per_m * h * h;
  const double k_r = coupling.stiffness_Nm_per_rad * h * h;
  Resistance M;
  M.topLeftCorner<3, 3>() = k_t * Mat3::Identity();
  M.topRightCorner<3, 3>() = -k_t * S;
  M.bottomLeftCorner<3, 3>() = k_t * S;
  M.bottomRightCorner<3, 3>() = k_r * Mat3::Identity() - k_t * S * S;
  return M;
}

}  // namespace tactum
