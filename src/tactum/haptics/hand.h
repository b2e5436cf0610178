#pragma once
/// The pose of the probe in the world: the device's handle, mapped by workspace scale and clutch.
///
///   X_WH.p = X_WD (scale p_DH)     X_WH.R = R_WD R_DH     a force in the world acts unscaled on the hand
///
/// So with a scale other than one a stiffness K of the world is scale * K at the device, and the work of the
/// hand at the device is 1 / scale of the work that its force does in the world.
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

/// The wrench `F_W` at the handle, turned from world axes into the device's. Its size is not scaled.
Wrench to_device(const HandTracking& hand, const Wrench& F_W) noexcept;

}  // namespace tactum::inline v0_1
