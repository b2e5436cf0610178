#pragma once
/// Contact of surfaces of revolution (geometry/revolution.h), from the minima that were found for their
/// facets: where the circles themselves are nearest.
///
///       .-"""-.             over a face: the lowest point of the circle; a roller touches with those of
///      /   +   \            its two ends
///      \   |   /            over an edge or a corner: the point of the cylinder that is nearest to it
///     __'-.v.-'__
///
/// All corners of a circle that are near a face give the same contact, whose place and gap change smoothly
/// while the body rolls. Circles lie outside of the facets.

#include "tactum/geometry/revolution.h"
#include "tactum/geometry/surface_tree.h"
#include "tactum/math/pose.h"
#include "tactum/surface/surface_minimum.h"

namespace tactum::inline v0_1 {

/// One of the two surfaces. `revolution` is null where its facets are the surface.
struct RevolvedSide {
  const SurfaceTree& tree;
  const Revolution* revolution = nullptr;
};

/// Makes of a minimum of the facets the contact of the curved surface. The feature of the turned part becomes
/// a corner of its circle. False, with nothing changed, where the facets are the contact: neither feature
/// lies on a circle, or both do; the part stands on its end, within `margin` [m]; the rim meets an edge.
bool meet_revolved(const RevolvedSide& a, const RevolvedSide& b, const Pose& X_AB, double margin,
                   SurfaceMinimum& minimum) noexcept;

}  // namespace tactum::inline v0_1
