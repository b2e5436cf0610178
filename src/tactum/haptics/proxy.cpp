#include "tactum/haptics/proxy.h"

#include "tactum/math/screw.h"

namespace tactum {

Twist velocity_to_hand(const Tool& tool, const Pose& X_WB, const Pose& X_WH, double dt_s) noexcept {
  return twist_between(X_WB, X_WH * tool.X_BH.inverse(), dt_s);
}

Twist within_threshold(const Twist& V, double radius, double max_step_m, double dt_s) noexcept {
  const double step = (V.v.norm() + V.w.norm() * radius) * dt_s;
  return step > max_step_m ? V * (max_step_m / step) : V;
}

}  // namespace tactum
