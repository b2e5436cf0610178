#pragma once
/// The hand on the handle: a mass that moves with the handle, tied by a spring and a damper in all six
/// directions to where the hand intends to be.
///
///      intended pose --[ k ]--+-- handle (device mass + hand mass)  <-- wrench of the device
///                   \--[ b ]--/
///
///   m a = k (x_intended - x) + b (v_intended - v) + F          the same turned, with a rotation vector
///
/// Stiffness is the same in every direction; a real hand is two or three times stiffer along some axes. The
/// lumped mass-spring-damper is the customary model of a hand holding a stylus [Kuchenbecker 2003].

#include <string>

#include "tactum/base/result.h"

namespace tactum::inline v0_1 {

struct HandModel {
  std::string name;                   ///< "medium"
  double mass_kg = 0.0;               ///< of the fingers that move with the handle [kg]
  double inertia_kg_m2 = 0.0;         ///< turning with the handle, about its origin [kg m^2]
  double stiffness_N_per_m = 0.0;     ///< [N/m]
  double damping_Ns_per_m = 0.0;      ///< [N s/m]
  double stiffness_Nm_per_rad = 0.0;  ///< [N m/rad]
  double damping_Nms_per_rad = 0.0;   ///< [N m s/rad]
};

/// The grips "loose", "medium" and "firm".
Result<HandModel> hand_model(const std::string& grip);

/// Nobody holds the device: it moves by its own inertia only.
HandModel no_hand();

}  // namespace tactum::inline v0_1
