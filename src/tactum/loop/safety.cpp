#include "tactum/loop/safety.h"

#include <algorithm>
#include <cmath>

#include "tactum/math/screw.h"

namespace tactum::inline v0_1 {
namespace {

using namespace safety_flag;

constexpr double kFullScaleTime_s = 0.005;

/// A frozen pose is a fault when more than this fraction of the largest force (torque) would go on being
/// sent.
constexpr double kMatters = 0.01;

/// Scales `v` to at most `limit`; true when it did. A limit of zero gives exactly zero.
bool limit_length(Vec3& v, double limit) noexcept {
  const double length = v.norm();
  if (!(length > limit)) return false;
  v *= limit / length;  // a length that overflows to infinity gives zero
  return true;
}

/// Moves `v` back to within `step` of `from`; true when it did.
bool limit_step(const Vec3& from, Vec3& v, double step) noexcept {
  Vec3 change = v - from;
  if (!limit_length(change, step)) return false;
  v = from + change;
  return true;
}

/// Whether the turn between two rotations is longer than `limit` [rad]. The chord of the matrices is at least
/// 2 sqrt(2) / pi of the angle: where it is short, as always but in a fault, the angle is not needed.
bool turns_beyond(const Mat3& from, const Mat3& to, double limit) noexcept {
  constexpr double kAngleOfChord =
      1.12;  // pi / (2 sqrt(2)) = 1.1107; the rest covers a matrix that is rounded
  if (kAngleOfChord * (to - from).norm() <= limit) return false;
  return log_rotation(to * from.transpose()).norm() > limit;
}

/// The faults in the motion of a plausible pose; stores the pose.
std::uint32_t faults_of_motion(const SafetyLimits& limits, SafetyState& state,
                               const SafetyInput& input) noexcept {
  const double time_s = input.now_s - input.sample_age_s;
  std::uint32_t flags = 0;
  if (state.measured) {
    // The first argument is kept when the second is NaN.
    const double since_s = std::max(input.period_s, time_s - state.measured_s);
    if ((input.X_DH.p - state.X_DH.p).norm() > limits.max_speed_m_per_s * since_s ||
        turns_beyond(state.X_DH.R, input.X_DH.R, limits.max_turn_rad_per_s * since_s))
      flags |= kPoseLeapt;
    const bool still = input.X_DH.p == state.X_DH.p && input.X_DH.R == state.X_DH.R;
    state.still_s = still ? state.still_s + input.period_s : 0.0;
    const bool matters = input.wanted.f.norm() > kMatters * limits.max_force_N ||
                         input.wanted.t.norm() > kMatters * limits.max_torque_Nm;
    if (state.still_s > limits.max_still_s && matters) flags |= kPoseFrozen;
  }
  state.X_DH = input.X_DH;
  state.measured_s = time_s;
  state.measured = true;
  return flags;
}

std::uint32_t faults(const SafetyLimits& limits, SafetyState& state, const SafetyInput& input) noexcept {
  std::uint32_t flags = 0;
  if (!input.wanted.finite() || !std::isfinite(input.period_s) || input.period_s <= 0.0)
    flags |= kNonFiniteWrench;
  const bool pose_is_plausible = plausible(input.X_DH);
  if (!pose_is_plausible) flags |= kImplausiblePose;
  // Written so that a NaN is stale; a sample from the future comes from a broken clock.
  if (!(std::abs(input.sample_age_s) <= limits.max_sample_age_s)) flags |= kStaleSample;
  state.invalid_s = input.sample_valid ? 0.0 : state.invalid_s + input.period_s;
  // A quarter of a period less, since sums of periods are rounded.
  if (state.invalid_s + 0.25 * input.period_s > limits.max_invalid_s && !input.sample_valid)
    flags |= kReadsFailing;
  if (input.late) flags |= kMissedDeadline;
  if (input.refused) flags |= kWrenchRefused;
  if (!input.motors_on) flags |= kMotorsOff;
  if (input.sample_valid && pose_is_plausible) flags |= faults_of_motion(limits, state, input);
  return flags;
}

/// Moves the gain along its ramp. A ramp of no length is a step.
std::uint32_t move_gain(const SafetyLimits& limits, SafetyState& state, const SafetyInput& input) noexcept {
  const double ramp_s = input.stop ? limits.stop_ramp_s : limits.start_ramp_s;
  const double step = ramp_s > input.period_s ? input.period_s / ramp_s : 1.0;
  state.gain = std::clamp(state.gain + (input.stop ? -step : step), 0.0, 1.0);
  if (input.stop) return kStopping;
  return state.gain < 1.0 ? kStarting : 0;
}

}  // namespace

SafetyLimits safety_limits(const DeviceInfo& info) noexcept {
  SafetyLimits limits;
  limits.max_force_N = std::max(0.0, info.max_force_N);
  limits.max_torque_Nm = std::max(0.0, info.max_torque_Nm);
  limits.max_force_slew_N_per_s = limits.max_force_N / kFullScaleTime_s;
  limits.max_torque_slew_Nm_per_s = limits.max_torque_Nm / kFullScaleTime_s;
  if (info.max_still_s > 0.0) limits.max_still_s = info.max_still_s;
  return limits;
}

SafetyLimits tightened(const SafetyLimits& limits, const SafetySettings& settings) noexcept {
  // std::min and std::max keep their first argument when the second is NaN.
  const auto smaller = [](double limit, double asked) { return std::max(0.0, std::min(limit, asked)); };
  SafetyLimits result = limits;
  result.max_force_N = smaller(limits.max_force_N, settings.max_force_N);
  result.max_torque_Nm = smaller(limits.max_torque_Nm, settings.max_torque_Nm);
  result.max_force_slew_N_per_s = smaller(limits.max_force_slew_N_per_s, settings.max_force_slew_N_per_s);
  result.max_torque_slew_Nm_per_s =
      smaller(limits.max_torque_slew_Nm_per_s, settings.max_torque_slew_Nm_per_s);
  result.start_ramp_s = std::max(limits.start_ramp_s, settings.start_ramp_s);
  result.stop_ramp_s = smaller(limits.stop_ramp_s, settings.stop_ramp_s);
  return result;
}

SafetyInput safety_input(const DeviceSample& sample, const FrameTick& tick, const Wrench& wanted) noexcept {
  return {.wanted = wanted,
          .X_DH = sample.X_DH,
          .sample_valid = sample.valid,
          .sample_age_s = tick.now_s - sample.time_s,
          .motors_on = sample.motors_on,
          .refused = tick.refused,
          .now_s = tick.now_s,
          .period_s = tick.period_s,
          .late = tick.late,
          .stop = tick.stop};
}

Wrench within_limits(const SafetyLimits& limits, const Wrench& F, std::uint32_t& flags) noexcept {
  Wrench within = F;
  if (limits.max_force_N > 0.0 && limit_length(within.f, limits.max_force_N)) flags |= kForceLimited;
  if (limits.max_torque_Nm > 0.0 && limit_length(within.t, limits.max_torque_Nm)) flags |= kTorqueLimited;
  return within;
}

Wrench safe_wrench(const SafetyLimits& limits, SafetyState& state, const SafetyInput& input,
                   std::uint32_t& flags) noexcept {
  const std::uint32_t found = faults(limits, state, input);
  flags |= found;
  if (found != 0) {
    state.gain = 0.0;
    state.sent = {};
    return state.sent;
  }
  flags |= move_gain(limits, state, input);
  if (input.stop && state.gain <= 0.0) {
    flags |= kStopped;
    state.sent = {};
    return state.sent;
  }
  Wrench F = input.wanted;
  if (limit_length(F.f, limits.max_force_N)) flags |= kForceLimited;
  if (limit_length(F.t, limits.max_torque_Nm)) flags |= kTorqueLimited;
  F = F * state.gain;
  if (limit_step(state.sent.f, F.f, limits.max_force_slew_N_per_s * input.period_s)) {
    flags |= kForceSlewed;
  }
  if (limit_step(state.sent.t, F.t, limits.max_torque_slew_Nm_per_s * input.period_s)) {
    flags |= kTorqueSlewed;
  }
  // The last wrench may lie outside limits that were tightened since; a slewed one must not.
  if (limit_length(F.f, limits.max_force_N)) flags |= kForceLimited;
  if (limit_length(F.t, limits.max_torque_Nm)) flags |= kTorqueLimited;
  state.sent = F;
  return F;
}

std::string safety_flag_names(std::uint32_t flags) {
  static constexpr struct {
    std::uint32_t flag;
    const char* name;
  } kNames[] = {
      {kForceLimited, "force limited"},
      {kTorqueLimited, "torque limited"},
      {kForceSlewed, "force slew limited"},
      {kTorqueSlewed, "torque slew limited"},
      {kStarting, "starting"},
      {kStopping, "stopping"},
      {kStopped, "stopped"},
      {kNonFiniteWrench, "wrench not finite"},
      {kImplausiblePose, "pose not finite"},
      {kStaleSample, "sample stale"},
      {kReadsFailing, "reads failing"},
      {kMissedDeadline, "deadline missed"},
      {kPoseLeapt, "pose leapt"},
      {kPoseFrozen, "pose frozen"},
      {kWrenchRefused, "wrench refused"},
      {kMotorsOff, "motors off"},
  };
  std::string text;
  for (const auto& entry : kNames) {
    if ((flags & entry.flag) != 0) text += (text.empty() ? "" : ", ") + std::string(entry.name);
  }
  return text;
}

}  // namespace tactum::inline v0_1
