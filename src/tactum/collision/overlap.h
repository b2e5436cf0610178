#pragma once
/// Two quick proofs that pieces share a point, from the answers of the last frame. D is the set of all b - a,
/// points of B less points of A: the pieces overlap where D holds the origin, and D is convex.
///
///     by four vertices              by a facet and the centres
///
///          d2                         ---facet---x---
///         / | \                        \        /  /
///       d0--o--d3                       \     o   /      o: the origin
///         \ | /                          \   /   /       c: center_b - center_a, inside D
///          d1                             \ /   /        x: where the line from c through o
///                                          c                 leaves the plane of the facet
///
///     o between the corners         x on the facet, so o between c and x
///
/// The first lasts while the pieces are deep inside each other, the second while they barely overlap. Either
/// may fail for pieces that do overlap: failure proves nothing. Cost: 15-25 ns each.

#include "tactum/collision/pair_view.h"

namespace tactum::inline v0_1 {

/// Whether the corners of `proof` have the origin between them. `proof` may be any pair's.
bool overlap_by_vertices(const PairView& pair, const OverlapProof& proof) noexcept;

/// Whether the origin is behind the facet of D of `depth`, an answer of penetration_depth for this pose.
bool overlap_by_facet(const PairView& pair, const PairDistance& depth) noexcept;

}  // namespace tactum::inline v0_1
