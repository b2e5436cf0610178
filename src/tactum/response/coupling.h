#pragma once
/// The virtual coupling: the spring and damper between the hand and the proxy of the held part, "a simple
/// spring model based on the transformation from the actual probe to its proxy" [Gregory 2000, 6.1]. Both
/// ends are told at the handle: its pose X_WH by the device, and X_WB X_BH by the held body.

#include "tactum/dynamics/joint.h"
#include "tactum/response/settings.h"

namespace tactum {

/// What the hand feels, at the handle, world axes: pulled and turned towards the proxy.
Wrench coupling_wrench(const Coupling& coupling, const Pose& X_WH, const Twist& V_WH, const Pose& X_WH_proxy,
                       const Twist& V_WH_proxy) noexcept;

/// How a proxy without mass resists being moved away from the hand over a step of `h` seconds: an impulse F h
/// moves its handle by F / k, so M = k h^2, shifted from the handle to the body's origin (lever `r_BH_W`
/// [m]).
Resistance coupling_resistance(const Coupling& coupling, const Vec3& r_BH_W, double h) noexcept;

}  // namespace tactum
