#pragma once
/// The inertia of a handle as a hand, or a motor's force at the handle, meets it.

#include "tactum/math/spatial.h"

namespace tactum::inline v0_1 {

struct ApparentInertia {
  double mass_kg = 0.0;        ///< 0: unknown [kg]
  double inertia_kg_m2 = 0.0;  ///< 0: unknown [kg m^2]
};

/// The least mass and the least moment of inertia of all directions. `stated` takes velocity and angular
/// velocity of the handle to its momentum; the handle is free in all six, so a push may turn it as well,
/// which makes it lighter than its block alone. A block that is not positive, as the turning of a device
/// without a wrist, is left out, and counts as unknown. What no device can have, such as a ton, is unknown.
ApparentInertia least_apparent(const Eigen::Matrix<double, 6, 6>& stated);

}  // namespace tactum::inline v0_1
