#pragma once
/// Convex shapes made by rule: for scenes, tests and benches. All centred on the origin.

#include "tactum/geometry/polytope.h"

namespace tactum::inline v0_1 {

/// A box with the given half edge lengths [m].
Polytope make_box(const Vec3& half_m);

/// A prism over a regular n-gon of circumradius `radius_m`, axis z, total height `height_m`; n >= 3.
Polytope make_prism(int sides, double radius_m, double height_m);

/// The icosahedron divided `subdivisions` times, corners on a sphere: 12, 42, 162, 642, 2562 ... vertices.
Polytope make_icosphere(int subdivisions, double radius_m);

/// An ellipsoid: the icosphere scaled along the axes.
Polytope make_ellipsoid(int subdivisions, const Vec3& radii_m);

}  // namespace tactum::inline v0_1
