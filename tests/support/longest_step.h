#pragma once
/// The setting of the longest step in the penalty response, from the step in a frame.

#include "tactum/response/workspace_scale.h"

namespace tactum {

/// Penalty::max_step_m with which the grasped part goes `step_m` at most in a frame of `dt_s`.
inline double longest_step_setting(double step_m, double dt_s) {
  FrameSettings settings;
  settings.response = ResponseModel::kPenalty;
  settings.dt_s = dt_s;
  settings.penalty.max_step_m = 1.0;
  return step_m / step_limits(settings, 0.0).step_m;
}

}  // namespace tactum
