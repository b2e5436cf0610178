#pragma once
/// Convex hulls as polytopes, by Qhull, with properties that the contact core needs and Qhull does not
/// promise: facets that are planar to 1e-12 of the size and no two of them coplanar, no corner in the middle
/// of an edge or face.
///
/// Merging facets that are coplanar and *only* those matters: left apart, the Voronoi region of the edge
/// between them is empty and the tracker can stop on either side of it; merged when not planar, the plane of
/// the face is wrong for some of its corners. Both were measured to give wrong distances.

#include <vector>

#include "tactum/base/result.h"
#include "tactum/geometry/polytope.h"

namespace tactum::inline v0_1 {

/// The hull of `points` [m]. Points of one plane give a flat polytope (two faces). An error when points are
/// not finite, fewer than three, all on one line, or when the hull has more than 65 535 vertices. Cost: n log
/// n.
Result<Polytope> convex_hull(const std::vector<Vec3>& points);

/// A flat polytope from a convex polygon's corners in order; face 0 is seen counter-clockwise.
Result<Polytope> flat_polygon(const std::vector<Vec3>& corners);

}  // namespace tactum::inline v0_1
