#pragma once
/// The linear smoothing scheme of [Gregory 2000, 5.3]: no displayed force differs from the last by more than
/// about F_max. The paper's frames take 1 ms. With longer or shorter ones F_max grows or shrinks with the
/// step, so that the force rises and falls as fast at every rate.
///
///   d = F1 - F0            |d| > 2 F_max :  show F0 + F_max in the direction of d
///                          |d| >   F_max :  show (F0 + F1) / 2
///                          otherwise     :  show F1
///
/// The paper states it for numbers with F1 > F0, "without loss of generality"; here d is the difference
/// vector, so a falling or turning force is treated alike, and force and torque are smoothed apart, each with
/// its own F_max. Every shown step is at most F_max; the branches meet there: both give F0 + F_max at |d| = 2
/// F_max, while the step falls from F_max to F_max / 2 as |d| rises past F_max, which is the paper's and is
/// kept. Cost: two square roots.

#include "tactum/math/spatial.h"

namespace tactum::inline v0_1 {

struct SmoothingSettings {
  double max_force_step_N = 0.5;     ///< F_max of the force in 1 ms; infinity: no smoothing [N]
  double max_torque_step_Nm = 0.01;  ///< F_max of the torque in 1 ms; infinity: no smoothing [N m]
  bool on = true;                    ///< false: the computed force is shown
};

struct SmoothingState {
  Wrench shown;  ///< what was returned in the last frame: FrameReport::smoothed, not ::shown [N, N m]
};

/// The scheme for one vector: what to show after `F0` when `F1` was computed.
Vec3 smoothed(const Vec3& F0, const Vec3& F1, double F_max) noexcept;

/// The scheme for force and torque, with `dt_s` from frame to frame [s]; remembers what it returns.
Wrench smooth_wrench(const SmoothingSettings& settings, double dt_s, SmoothingState& state,
                     const Wrench& computed) noexcept;

}  // namespace tactum::inline v0_1
