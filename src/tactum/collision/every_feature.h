#pragma once
/// Closest features by trying every pair: the last resort of closest_features for small pieces that do not
/// overlap. Cost: (E_A E_B + V_A F_B + F_A V_B) x 10 ns; two boxes 3 us.

#include "tactum/collision/voronoi_march.h"

namespace tactum {

/// The nearest of all vertex-face and edge-edge pairs (which hold all others), at the vertex or edge the
/// points are on.
March closest_of_every_feature(const PairView& pair) noexcept;

}  // namespace tactum
