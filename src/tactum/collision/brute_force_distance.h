#pragma once
/// Closest features by trying every pair: the last resort of closest_features for small pieces that do not
/// overlap. Cost: (E_A E_B + V_A F_B + F_A V_B) x 10 ns; two boxes 3 us.

#include "tactum/collision/pair_view.h"

namespace tactum::inline v0_1 {

/// Sets in `x` the points and features of the nearest of all vertex-face and edge-edge pairs (which include
/// all others), at the vertex or edge the points are on.
void brute_force_distance(const PairView& pair, PairDistance& x) noexcept;

}  // namespace tactum::inline v0_1
