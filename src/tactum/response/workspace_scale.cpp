#include "tactum/response/workspace_scale.h"

#include <algorithm>

#include "tactum/base/frame_rate.h"

namespace tactum::inline v0_1 {
namespace {

/// The radius of a part of a hand's size: turned by Constraint::max_turn_rad, its points travel
/// Constraint::max_step_m.
constexpr double kHandRadius_m = 0.05;

}  // namespace

Coupling in_scene(const Coupling& at_device, double scale) noexcept {
  return {at_device.stiffness_N_per_m / scale, at_device.stiffness_Nm_per_rad * scale,
          at_device.damping_Ns_per_m / scale, at_device.damping_Nms_per_rad * scale};
}

Wrench at_device(const Wrench& in_scene, double scale) noexcept { return {in_scene.f, in_scene.t / scale}; }

StepLimits step_limits(const FrameSettings& settings, double scale, double radius_m) noexcept {
  const Constraint& c = settings.constraint;
  const bool penalty = settings.response == ResponseModel::kPenalty;
  // The published threshold keeps a step below what springs can stop, whatever the part's size.
  const double larger = penalty ? scale : std::max(scale, radius_m / kHandRadius_m);
  const double steps = settings.dt_s / kReferenceStep_s;
  return {.step_m = (penalty ? settings.penalty.max_step_m : c.max_step_m) * larger * steps,
          .least_step_m = c.least_step_m * scale,
          .turn_rad = c.max_turn_rad * steps};
}

}  // namespace tactum::inline v0_1
