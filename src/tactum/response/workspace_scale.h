#pragma once
/// The workspace scale s shows a metre of the device as s metres of the scene. Turns are the same on both
/// sides, and so are forces: a weight of 1 N is felt as 1 N at every scale. Everything else follows from
/// these two:
///
///                          device    scene
///   length, velocity       x         s x
///   turn                   a         a
///   force                  f         f
///   torque                 t         s t      the lever arms are s times as long
///   stiffness, damping     k         k / s
///   ... against turning    k         s k
///   energy, power          E         s E      by the same factor for pushing and for turning
///
/// So a scene that is s times as large feels the same. The settings of the coupling, of contact springs and
/// of steps are stated at the device: what bounds them there holds at every scale. The functions here give
/// what they are in the scene.

#include "tactum/response/settings.h"

namespace tactum::inline v0_1 {

/// A coupling with a share of its stiffness; its dampers stay.
inline Coupling softened(Coupling coupling, double share) noexcept {
  coupling.stiffness_N_per_m *= share;
  coupling.stiffness_Nm_per_rad *= share;
  return coupling;
}

/// The coupling between probe and proxy in the scene.
Coupling in_scene(const Coupling& at_device, double scale) noexcept;

/// A wrench of the scene as the device has it, with the same axes.
Wrench at_device(const Wrench& in_scene, double scale) noexcept;

/// How far the grasped part may go in one frame, in the scene.
struct StepLimits {
  double step_m = 0.0;        ///< most that any point of it travels [m]
  double least_step_m = 0.0;  ///< what the trust region radius sinks to; constraint response [m]
  double turn_rad = 0.0;      ///< most that it turns; constraint response [rad]
};

/// The limits at a workspace scale for a part whose farthest point is `radius_m` from its origin, 0 when
/// nothing is grasped. The
/// settings hold for a part of a hand's size. In the constraint response a larger one may go farther, as its
/// points do when it turns.
StepLimits step_limits(const FrameSettings& settings, double scale, double radius_m) noexcept;
/// The same at the scale of the first hand.
inline StepLimits step_limits(const FrameSettings& settings, double radius_m) noexcept {
  return step_limits(settings, settings.workspace.scale, radius_m);
}

}  // namespace tactum::inline v0_1
