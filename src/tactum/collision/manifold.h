#pragma once
/// The contact patch of two convex pieces: where, over a common tangent plane, both have surface and the gap
/// is below the tolerance; represented by a few weighted points.
///
///   1. On each side take the largest feature at the closest point that is square to the normal within
///      2 degrees.
///   2. Look along the normal: both are flat figures in one plane (of two faces, B's), the gap is linear.
///
///          A \ B      vertex     edge                     face
///          vertex     point      point                    point
///          edge       point      point or shared interval edge clipped by the face
///          face       point      edge clipped by the face polygon clipped by polygon
///
///   3. Cut off where the gap exceeds the tolerance, and as a feature leans toward the limit of 1., toward
///      its edge and its vertex: as the pieces tilt the patch shrinks, it does not jump.
///   4. Replace the patch by points with the same area, centroid and second moments C: a polygon by four,
///      c +- u and c +- v, with u and v the columns of the symmetric root of 2 C; an interval by its two
///      Gauss points. Any force that is linear in the gap, and its torque, is then the exact integral over
///      the patch. Points keep their identities while the features stay.
///
/// The figures are cut along the contact normal, by the borders of the face they are cut with. Steps 3 and 4
/// differ from [Gregory 2000, 4.1]: the bare corners of the clipped polygon appear and vanish, and their mean
/// jumps with them. Cost: see docs/algorithms/manifold.md.
/// them. Cost: see docs/algorithms/manifold.md.

#include <span>

#include "tactum/collision/contact.h"
#include "tactum/collision/stretch.h"
#include "tactum/geometry/polytope.h"

namespace tactum::inline v0_1 {

/// The patch at `closest`, an answer of closest_features or penetration_depth for the same pose, where the
/// gap is below `tolerance` [m]. Empty only when closest.distance >= tolerance (or it has no normal).
void contact_manifold(const Polytope& A, const Polytope& B, const Pose& X_AB, const PairDistance& closest,
                      double tolerance, Manifold& out) noexcept;

/// The same with another angle, well below a right one [rad], for "square to the normal".
void contact_manifold_within(const Polytope& A, const Polytope& B, const Pose& X_AB,
                             const PairDistance& closest, double tolerance, double angle,
                             Manifold& out) noexcept;

/// The patch of A and B and of all `others` as one: the points are those of the features uncut. Cost: that of
/// a patch for each stretch, up to four times as they lean.
void contact_manifold_over(const Polytope& A, const Polytope& B, const Pose& X_AB,
                           const PairDistance& closest, double tolerance, std::span<const Stretch> others,
                           Manifold& out) noexcept;

}  // namespace tactum::inline v0_1
