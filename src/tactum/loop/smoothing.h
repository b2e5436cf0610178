#pragma once
/// The linear smoothing scheme of [Gregory 2000, 5.3]: no displayed force differs from the last by more than
/// about F_max.
///
///   d = F1 - F0            |d| > 2 F_max :  show F0 + F_max in the direction of d
///                          |d| >   F_max :  show (F0 + F1) / 2
///                          otherwise     :  show F1
///
/// The paper states it for numbers with F1 > F0, "without loss of generality"; here d is the difference
/// vector, so a falling or turning force is treated alike, and force and torque are smoothed apart, each with
/// its own F_max. Every shown step is at most F_max; the branches meet there: both give F0 + F_max at |d| = 2
/// F_max, while the step falls from F_max to F_max / 2 as |d| rises past F_max, which is the paper's and is
/// kept.
///
/// F_max is stated per second, so that the force changes as fast at every rate. The published 0.5 N in 1 ms
/// lets through whatever parts do that meet. So before it stands a limit of what the hand can make: in every
/// frame the coupling's stiffness times the displacement of the hand, and at least a little (beyond_hand) for
/// all that changes by itself, such as a contact that snaps, a weight that drops, or a part that is hit.
/// Below it the computed force is shown as it is.
///
/// A hand cannot turn back within a frame, but encoder steps, contacts that change, and loops that are too
/// stiff can. So a step that goes against the last one is shorter still (reversal): what buzzes at the rate
/// of the frames stays below what is felt. With beyond_hand and reversal at infinity the scheme is the
/// published one to the letter. Cost: four square roots.

#include <limits>

#include "tactum/math/spatial.h"

namespace tactum::inline v0_1 {

struct SmoothingSettings {
  double max_force_N_per_s = 500.0;   ///< F_max of the force over the time of a frame, at most [N/s]
  double max_torque_Nm_per_s = 10.0;  ///< F_max of the torque [N m/s]
  double beyond_hand_N_per_s = 45.0;  ///< the limit where the hand's motion explains less [N/s]
  double beyond_hand_Nm_per_s = 0.9;  ///< ... of the torque: the same at a lever of 20 mm [N m/s]
  double reversal_N_per_s = 19.0;     ///< the limit of a step against the last one [N/s]
  double reversal_Nm_per_s = 0.38;    ///< the same of the torque [N m/s]
  bool on = true;                     ///< false: the computed force is shown
};

/// The largest change of a wrench in one frame.
struct WrenchStep {
  double force_N = 0.0;    ///< [N]
  double torque_Nm = 0.0;  ///< [N m]
};

struct SmoothingState {
  Wrench shown;  ///< what was returned in the last frame: FrameReport::smoothed, not ::shown [N, N m]
  Wrench step;   ///< by how much it differed from the one before [N, N m]
  /// What the hand explains: of this frame, or what is left of earlier ones, since the part follows the hand
  /// with a delay of some frames.
  WrenchStep explained;
};

/// The scheme for one vector: what to show after `F0` when `F1` was computed.
Vec3 smoothed(const Vec3& F0, const Vec3& F1, double F_max) noexcept;

/// The change that a displacement of the hand explains, when a coupling of these stiffnesses [N/m, N m/rad]
/// holds a part whose points are at most `lever_m` from the handle.
WrenchStep explained_by(const Twist& displacement, double stiffness_N_per_m, double stiffness_Nm_per_rad,
                        double lever_m) noexcept;

/// The scheme for force and torque, with `dt_s` from frame to frame [s] and what the hand explains in this
/// one; remembers what it returns.
Wrench smooth_wrench(const SmoothingSettings& settings, double dt_s, const WrenchStep& explained,
                     SmoothingState& state, const Wrench& computed) noexcept;

}  // namespace tactum::inline v0_1
