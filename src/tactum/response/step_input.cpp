#include "tactum/response/step_input.h"

#include <algorithm>

namespace tactum::inline v0_1 {

HandInput hand_input(const FrameSettings& settings, const HandSettings& hand, const GraspedPart& grasped,
                     std::span<const double> radius_m, double share, double left) noexcept {
  const double radius = grasped.body < 0 ? 0.0 : radius_m[static_cast<std::size_t>(grasped.body)];
  Coupling coupling = in_scene(softened(hand.coupling, left * share), hand.workspace.scale);
  coupling.damping_Ns_per_m *= left;
  coupling.damping_Nms_per_rad *= left;
  return {.grasped = grasped,
          .coupling = coupling,
          .limits = step_limits(settings, hand.workspace.scale, radius),
          .left = left};
}

MotionInput motion_input(const World& world, const FrameSettings& settings, std::span<const HandInput> hands,
                         std::span<const double> radius_m) noexcept {
  StepLimits least = hands.front().limits;
  for (const HandInput& hand : hands.subspan(1))
    least = {std::min(least.step_m, hand.limits.step_m),
             std::min(least.least_step_m, hand.limits.least_step_m),
             std::min(least.turn_rad, hand.limits.turn_rad)};
  return {world, settings, hands, radius_m, settings.dt_s, least, settings.smallest_scale()};
}

}  // namespace tactum::inline v0_1
