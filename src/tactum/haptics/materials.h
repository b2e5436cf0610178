#pragma once
/// Friction and restitution by the materials of the bodies (Body::material), as scene files give them. A
/// program fills FrameSettings::friction and Impacts::restitution with them once all bodies are added:
///
///   set_coefficient(world, {"steel", "wood", 0.4}, settings.friction)

#include <string>

#include "tactum/base/result.h"
#include "tactum/dynamics/world.h"
#include "tactum/response/settings.h"

namespace tactum::inline v0_1 {

/// A coefficient for every body of one material with every body of the other; the order is of no account.
struct MaterialPair {
  std::string material_a;
  std::string material_b;
  double coefficient = 0.0;  ///< [-]
};

/// Sets the coefficient of all pairs of bodies of these two materials; the last call for a pair counts. Pairs
/// that no call has named have 0. An error when no body is of a material, or the coefficient is negative or
/// not finite; Error::where then names the member of MaterialPair.
Result<void> set_coefficient(const World& world, const MaterialPair& pair, PairCoefficients& table);

}  // namespace tactum::inline v0_1
