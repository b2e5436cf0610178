#pragma once
/// Volume, centre of mass and inertia of a solid from its closed surface. Every triangle spans a tetrahedron
/// with a fixed point; its moments are polynomials of the corners, and signed by orientation they add up to
/// the solid's (divergence theorem; Mirtich 1996, Tonon 2004). O(triangles), exact up to rounding.

#include <string>
#include <vector>

#include "tactum/base/result.h"
#include "tactum/geometry/triangle_mesh.h"

namespace tactum::inline v0_1 {

struct MassProperties {
  double volume = 0.0;          ///< [m^3]
  double mass = 0.0;            ///< [kg]
  Vec3 center = Vec3::Zero();   ///< of mass, in the mesh's frame [m]
  Mat3 inertia = Mat3::Zero();  ///< about the centre of mass, axes of the mesh's frame [kg m^2]
  std::string approximation;    ///< empty when exact; else a sentence that names the replacement of the solid
};

/// Of a surface with normals outward that runs along every edge as often one way as the other: closed and
/// oriented, or solids that touch in edges or faces. Anything else is an error that states what is open, or
/// that the surface crosses itself so that its parts cancel and the moments are those of no solid.
Result<MassProperties> mass_properties(const TriangleMesh& mesh, double density_kg_per_m3);

/// Of any welded mesh: exact when the surface is closed (reversed when its normals point inward); of its
/// solids when sheets beside them have the smaller area; otherwise of the convex hull, or of the bounding
/// box when the points lie in a plane. `approximation` states which. The centre is always within the mesh's
/// box, and the moments of inertia are those of a solid.
MassProperties mass_properties_or_hull(const TriangleMesh& mesh, double density_kg_per_m3);

}  // namespace tactum::inline v0_1
