#pragma once
/// The intended motion of the hand: a pose, its velocity and the buttons as functions of time. A motion is
/// immutable and has no memory, so it can be evaluated at any time, in any order, for any number of devices.
///
///   ScriptedMotion   move_to, turn_about and hold, one after the other
///   TremorMotion     another motion with small sinusoids on top
///
/// A move takes its time with the minimum-jerk profile s = 10 q^3 - 15 q^4 + 6 q^5 that people's reaching
/// movements follow [Flash and Hogan 1985]; speed and acceleration are zero at both ends.

#include <cstdint>
#include <memory>
#include <vector>

#include "tactum/base/result.h"
#include "tactum/math/spatial.h"

namespace tactum::inline v0_1 {

/// The intention at one instant, in the device frame D.
struct HandState {
  Pose X_DH;                  ///< the intended pose of the handle [m]
  Twist V_DH;                 ///< its intended velocity [m/s, rad/s]
  std::uint32_t buttons = 0;  ///< bit 0 is the primary button
};

class HandMotion {
 public:
  virtual ~HandMotion() = default;
  /// The intention `time_s` after the motion's beginning. Before it and after its end the hand rests.
  virtual HandState at(double time_s) const noexcept = 0;
  virtual double duration_s() const noexcept = 0;

 protected:
  HandMotion() = default;
  HandMotion(const HandMotion&) = default;
  HandMotion& operator=(const HandMotion&) = default;
};

/// A pose to be at, at a time.
struct Keyframe {
  double time_s = 0.0;  ///< since the motion's beginning [s]
  Pose X_DH;            ///< [m]
  std::uint32_t buttons = 0;
};

/// How a segment's time is spent.
enum class MotionProfile {
  kMinimumJerk,  ///< from rest to rest
  kSteady        ///< constant speed
};

/// Segments in a row. Built by appending; each segment starts where the last one ended.
class ScriptedMotion final : public HandMotion {
 public:
  explicit ScriptedMotion(const Pose& X_DH_start = {}) : X_end_(X_DH_start) {}

  /// The origin goes straight, the orientation by one rotation, to `X_DH` in `duration_s` > 0.
  ScriptedMotion& move_to(double duration_s, const Pose& X_DH,
                          MotionProfile profile = MotionProfile::kMinimumJerk, std::uint32_t buttons = 0);
  /// The handle turns with the line through `p_D` along `axis_D` (any length) by `angle_rad`: its origin
  /// follows an arc, as a hand on a crank does; with the origin on the line it only turns.
  ScriptedMotion& turn_about(double duration_s, const Vec3& p_D, const Vec3& axis_D, double angle_rad,
                             MotionProfile profile = MotionProfile::kMinimumJerk, std::uint32_t buttons = 0);
  ScriptedMotion& hold(double duration_s, std::uint32_t buttons = 0);

  HandState at(double time_s) const noexcept override;
  double duration_s() const noexcept override { return end_s_; }
  const Pose& end_pose() const noexcept { return X_end_; }

 private:
  struct Segment {
    double start_s;     // [s]
    double duration_s;  // [s]
    Pose X_start;       // at its beginning
    Twist step;         // move: from start to end in unit time; turn: step.w is axis times angle
    Vec3 p_line;        // turn: a point on the axis
    bool is_turn;
    MotionProfile profile;
    std::uint32_t buttons;
  };
  void append(const Segment& segment);

  std::vector<Segment> segments_;
  Pose X_end_;
  double end_s_ = 0.0;
};

/// Minimum-jerk moves from keyframe to keyframe; a keyframe's buttons are kept until the next one. Errors
/// name the keyframe: times must increase, poses must be finite rotations.
Result<ScriptedMotion> motion_through(const std::vector<Keyframe>& keyframes);

/// One sinusoid of a tremor: both amplitudes times sin(2 pi f t + phase).
struct TremorComponent {
  Vec3 translation_m = Vec3::Zero();  ///< [m]
  Vec3 rotation_rad = Vec3::Zero();   ///< rotation vector [rad]
  double frequency_Hz = 10.0;         ///< [Hz]
  double phase_rad = 0.0;             ///< [rad]
};

/// Three sinusoids between 8 and 12 Hz, the band of physiological tremor, with directions and phases from
/// `seed`; the amplitudes [m], [rad] are those of the sum's largest possible value.
std::vector<TremorComponent> physiological_tremor(double translation_m, double rotation_rad,
                                                  std::uint64_t seed);

/// `base` with a tremor on top, during and after it.
class TremorMotion final : public HandMotion {
 public:
  TremorMotion(std::shared_ptr<const HandMotion> base, std::vector<TremorComponent> components)
      : base_(std::move(base)), components_(std::move(components)) {}
  HandState at(double time_s) const noexcept override;
  double duration_s() const noexcept override { return base_->duration_s(); }

 private:
  std::shared_ptr<const HandMotion> base_;
  std::vector<TremorComponent> components_;
};

}  // namespace tactum::inline v0_1
