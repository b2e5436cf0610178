#pragma once
/// The pose of the probe in the world: the device's handle, mapped by workspace scale and clutch.
///
///   X_WH.p = X_WD (scale p_DH)     f_D = R_DW f_W
///   X_WH.R = R_WD R_DH             t_D = R_DW t_W / scale
///
/// What follows for stiffness and energy stands in workspace_scale.h.
///
/// While the clutch button is pressed the handle may be moved back to the middle of the device: the probe
/// keeps its place in the world, and the mapping X_WD follows.

#include "tactum/devices/device.h"
#include "tactum/response/settings.h"

namespace tactum::inline v0_1 {

struct HandTracking {
  Pose X_WD;              ///< the mapping as the clutch has left it [m]
  Pose X_WH;              ///< the probe in the world in the last frame [m]
  Twist V_WH;             ///< its velocity [m/s, rad/s]
  double time_s = 0.0;    ///< of the last valid sample [s]
  bool known = false;     ///< false until the first valid sample
  bool clutched = false;  ///< the clutch was pressed in the last frame; the frame itself does not read it
};

/// Takes a sample in. An invalid or implausible one leaves the probe where it was. `dt_s` is the nominal time
/// between frames; the time between samples counts where it is longer.
void follow_hand(const Workspace& workspace, const DeviceSample& sample, double dt_s,
                 HandTracking& hand) noexcept;

/// The wrench `F_W` at the handle, of the scene and in world axes, as the device has it, in its axes.
Wrench to_device(const Workspace& workspace, const HandTracking& hand, const Wrench& F_W) noexcept;

}  // namespace tactum::inline v0_1
