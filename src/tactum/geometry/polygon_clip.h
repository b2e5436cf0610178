#pragma once
/// Convex polygons in space, cut by half-spaces. For set-up work; the frame has its own (planar_patch.h).

#include <vector>

#include "tactum/geometry/polytope.h"

namespace tactum::inline v0_1 {

/// The corners of a face, counter-clockwise seen from outside [m].
std::vector<Vec3> face_corners(const Polytope& polytope, int face);

/// Keeps the part of a convex polygon where normal . x <= offset. Empty when nothing is left.
void keep_below(std::vector<Vec3>& polygon, const Vec3& normal, double offset);

/// Of a convex polygon, seen from where `normal` points to [m^2].
double polygon_area(const std::vector<Vec3>& polygon, const Vec3& normal);

}  // namespace tactum::inline v0_1
