#pragma once
/// How often a closed line goes through another, counted with sign: the linking number.

#include "tactum/math/pose.h"
#include "tactum/referee/mesh_loops.h"

namespace tactum::inline v0_1 {

/// Of two closed lines without a common point, `b` at X_AB: Gauss's integral, summed over pairs of sides in
/// closed form [Klenin 2000]. An integer, up to rounding. Cost: the product of their sides.
double linking_number(const ClosedLine& a, const ClosedLine& b, const Pose& X_AB);

}  // namespace tactum::inline v0_1
