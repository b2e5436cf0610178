#pragma once
/// How often a surface goes round a point: 1 inside a closed surface wound outward, 0 outside, and between
/// for surfaces with holes [Jacobson 2013].

#include "tactum/geometry/triangle_mesh.h"

namespace tactum::inline v0_1 {

/// The generalized winding number: the sum of the solid angles of the triangles, as seen from the point, over
/// 4 pi. Linear in the triangles.
double winding_number(const TriangleMesh& mesh, const Vec3& point);

}  // namespace tactum::inline v0_1
