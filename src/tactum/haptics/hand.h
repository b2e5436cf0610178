#pragma once
/// Where is the hand? The device's handle told in the world: workspace scale and clutch.
///
///   X_WH.p = X_WD (scale p_DH)     X_WH.R = R_WD R_DH     a force in the world acts unscaled on the hand
///
/// While the clutch button is pressed the handle may be moved back to the middle of the device: the hand's
/// place in the world stays, and the mapping X_WD follows.

#include "tactum/devices/device.h"
#include "tactum/response/settings.h"

namespace tactum::inline v0_1 {

struct HandTracking {
  Pose X_WD;              ///< the mapping as the clutch has left it [m]
  Pose X_WH;              ///< the hand in the world in the last frame [m]
  Twist V_WH;             ///< its velocity [m/s, rad/s]
  double time_s = 0.0;    ///< of the last valid sample [s]
  bool known = false;     ///< false until the first valid sample
  bool clutched = false;  ///< the clutch was pressed in the last frame
};

/// Takes a sample in. An invalid or implausible one leaves the hand where it was. `dt_s` is the nominal time
/// between frames; the time between samples counts where it is longer.
void follow_hand(const Workspace& workspace, const DeviceSample& sample, double dt_s,
                 HandTracking& hand) noexcept;

/// A wrench at the handle, told with the device's axes.
Wrench to_device(const HandTracking& hand, const Wrench& F_W) noexcept;

}  // namespace tactum::inline v0_1
