#pragma once
/// Force fields as arrows on a coarse lattice, for the page to draw: the force on a point of unit weight
/// there.

#include <vector>

#include "tactum/dynamics/world.h"

namespace tactum {

struct FieldArrow {
  Vec3 p_W = Vec3::Zero();    ///< [m]
  Vec3 force = Vec3::Zero();  ///< of all fields together, with their scales, world axes [N]
};

/// Nodes along each side of the lattice, a box about the bodies and the middles of fields as they start.
inline constexpr int kArrowsASide = 7;

/// None without fields.
std::vector<FieldArrow> field_arrows(const World& world);

}  // namespace tactum
