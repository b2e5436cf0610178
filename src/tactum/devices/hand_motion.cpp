#include "tactum/devices/hand_motion.h"

#include <algorithm>
#include <cmath>

#include "tactum/base/assert.h"
#include "tactum/base/random.h"
#include "tactum/math/rotation.h"
#include "tactum/math/screw.h"

namespace tactum::inline v0_1 {
namespace {

/// Fraction of the path that is done, and its rate, against the fraction of the time spent.
struct Progress {
  double s;
  double rate;
};

Progress progress(MotionProfile profile, double q) {
  if (profile == MotionProfile::kSteady) return {q, 1.0};
  const double rest = 1.0 - q;
  return {q * q * q * (10.0 + q * (-15.0 + 6.0 * q)), 30.0 * q * q * rest * rest};
}

Pose turned(const Pose& X, const Vec3& p_line, const Vec3& rotation) {
  const Mat3 R = exp_rotation(rotation);
  return {R * X.R, p_line + R * (X.p - p_line)};
}

}  // namespace

void ScriptedMotion::append(const Segment& segment) {
  TACTUM_DEMAND(std::isfinite(segment.duration_s) && segment.duration_s > 0.0);
  segments_.push_back(segment);
  end_s_ += segment.duration_s;
}

ScriptedMotion& ScriptedMotion::move_to(double duration_s, const Pose& X_DH, MotionProfile profile,
                                        std::uint32_t buttons) {
  append(
      {end_s_, duration_s, X_end_, twist_between(X_end_, X_DH, 1.0), Vec3::Zero(), false, profile, buttons});
  X_end_ = X_DH;
  return *this;
}

ScriptedMotion& ScriptedMotion::turn_about(double duration_s, const Vec3& p_D, const Vec3& axis_D,
                                           double angle_rad, MotionProfile profile, std::uint32_t buttons) {
  TACTUM_DEMAND(axis_D.allFinite() && axis_D.norm() > 0.0);
  const Vec3 rotation = axis_D.normalized() * angle_rad;
  append({end_s_, duration_s, X_end_, {Vec3::Zero(), rotation}, p_D, true, profile, buttons});
  X_end_ = turned(X_end_, p_D, rotation);
  return *this;
}

ScriptedMotion& ScriptedMotion::hold(double duration_s, std::uint32_t buttons) {
  return move_to(duration_s, X_end_, MotionProfile::kSteady, buttons);
}

HandState ScriptedMotion::at(double time_s) const noexcept {
  if (segments_.empty()) return {X_end_, {}, 0};
  if (!(time_s >= 0.0)) return {segments_.front().X_start, {}, segments_.front().buttons};
  if (time_s >= end_s_) return {X_end_, {}, segments_.back().buttons};
  const auto next = std::upper_bound(segments_.begin(), segments_.end(), time_s,
                                     [](double t, const Segment& segment) { return t < segment.start_s; });
  const Segment& segment = *(next - 1);
  const double q = std::min((time_s - segment.start_s) / segment.duration_s, 1.0);
  const Progress done = progress(segment.profile, q);
  const double rate = done.rate / segment.duration_s;
  if (!segment.is_turn) {
    return {advanced(segment.X_start, segment.step, done.s), segment.step * rate, segment.buttons};
  }
  const Pose X = turned(segment.X_start, segment.p_line, segment.step.w * done.s);
  const Vec3 w = segment.step.w * rate;
  return {X, {w.cross(X.p - segment.p_line), w}, segment.buttons};
}

Result<ScriptedMotion> motion_through(const std::vector<Keyframe>& keyframes) {
  if (keyframes.empty()) return Error{"the motion has no keyframe", "an empty list", "at least one", ""};
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    const Keyframe& key = keyframes[i];
    const std::string where = "keyframe " + std::to_string(i + 1);
    if (!std::isfinite(key.time_s) || key.time_s < 0.0) {
      return Error{"bad time", std::to_string(key.time_s) + " s", "a time of zero or more", where};
    }
    if (i > 0 && !(key.time_s > keyframes[i - 1].time_s)) {
      return Error{"times must increase", std::to_string(key.time_s) + " s",
                   "more than " + std::to_string(keyframes[i - 1].time_s) + " s", where};
    }
    const NearestRotation rotation = orthonormalized(key.X_DH.R);
    if (!key.X_DH.p.allFinite() || !rotation.exists || rotation.deviation > tolerances::kRotationExact) {
      return Error{"bad pose", "a matrix that is no rotation or a number that is not finite",
                   "a finite position and a rotation", where};
    }
  }
  ScriptedMotion motion(keyframes.front().X_DH);
  if (keyframes.front().time_s > 0.0) motion.hold(keyframes.front().time_s, keyframes.front().buttons);
  for (std::size_t i = 1; i < keyframes.size(); ++i) {
    motion.move_to(keyframes[i].time_s - keyframes[i - 1].time_s, keyframes[i].X_DH,
                   MotionProfile::kMinimumJerk, keyframes[i - 1].buttons);
  }
  return motion;
}

std::vector<TremorComponent> physiological_tremor(double translation_m, double rotation_rad,
                                                  std::uint64_t seed) {
  constexpr int kComponents = 3;
  Random random(seed);
  const auto direction = [&random] {
    const double z = random.uniform(-1.0, 1.0);
    const double angle = random.uniform(-kPi, kPi);
    const double ring = std::sqrt(1.0 - z * z);
    return Vec3(ring * std::cos(angle), ring * std::sin(angle), z);
  };
  std::vector<TremorComponent> components;
  for (int i = 0; i < kComponents; ++i) {
    TremorComponent component;
    component.translation_m = direction() * (translation_m / kComponents);
    component.rotation_rad = direction() * (rotation_rad / kComponents);
    component.frequency_Hz = random.uniform(8.0, 12.0);
    component.phase_rad = random.uniform(-kPi, kPi);
    components.push_back(component);
  }
  return components;
}

HandState TremorMotion::at(double time_s) const noexcept {
  HandState state = base_->at(time_s);
  Vec3 offset = Vec3::Zero();
  Vec3 rotation = Vec3::Zero();
  Twist rate;
  for (const TremorComponent& component : components_) {
    const double omega = 2.0 * kPi * component.frequency_Hz;
    const double s = std::sin(omega * time_s + component.phase_rad);
    const double c = omega * std::cos(omega * time_s + component.phase_rad);
    offset += component.translation_m * s;
    rotation += component.rotation_rad * s;
    rate = rate + Twist{component.translation_m, component.rotation_rad} * c;
  }
  // The trembling turn comes after the intended one. Its rotation vector is small, so its rate is its
  // derivative to second order in the amplitude.
  const Mat3 R = exp_rotation(rotation);
  state.X_DH = {R * state.X_DH.R, state.X_DH.p + offset};
  state.V_DH = {state.V_DH.v + rate.v, R * state.V_DH.w + rate.w};
  return state;
}

}  // namespace tactum::inline v0_1
