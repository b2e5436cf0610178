#pragma once
/// The signed distance of two pieces of two parts: closest features while they are apart, and when they
/// overlap the depth that their kinds allow. A piece of a solid may be left by any face; a one-sided surface
/// piece (a triangle of a mesh that is no convex solid) only pushes out of the solid it bounds, so that a
/// thin or deep contact is not pushed through the wall.

#include "tactum/collision/contact.h"
#include "tactum/geometry/part.h"

namespace tactum {

/// Answer in the frame of part A, see contact.h.
PairDistance piece_distance(const Part& part_a, int piece_a, const Part& part_b, int piece_b,
                            const Pose& X_AB, PairCache& cache) noexcept;

/// Whether the contact lies on the outer side of both pieces; always true of pieces of solids.
bool faces_outward(const Part& part_a, int piece_a, const Part& part_b, int piece_b, const Pose& X_AB,
                   const PairDistance& found) noexcept;

}  // namespace tactum
