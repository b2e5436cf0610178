#pragma once
/// Contact of pieces that stand for spheres and cylinders (geometry/round_piece.h): where the curved surface
/// itself is nearest to the other piece, with its exact gap.
///
///            .-"""-.                  the point of a ball is where the line from its centre to the nearest
///          /    c    \                point of the other piece leaves it; that of a cylinder, likewise from
///          \    |    /                its axis, or, over a face, the two ends of the line where it lies
///     ______'-._v_.-'______           there
///
/// One row where a ball touches, two where a cylinder lies: their normals and gaps change smoothly while the
/// body rolls, where those of facets come and go. Curved surfaces lie outside of their facets, so the exact
/// gaps are smaller than those of the facets, and convex: a step that keeps the rows linearised keeps the
/// gaps.
///
/// Cost: 0.1 us.

#include "tactum/collision/contact.h"
#include "tactum/geometry/round_piece.h"

namespace tactum::inline v0_1 {

/// One of the two pieces. `round` may be null: the facets are its surface.
struct RoundSide {
  const Polytope& piece;
  const RoundPiece* round = nullptr;

  bool is(RoundKind kind) const noexcept { return round != nullptr && round->kind == kind; }
};

/// The exact contact of two pieces of which one or both are round, from what was found for their facets.
/// `found` becomes the nearest point, and `points` has every point nearer than `margin` [m], at most two; the
/// features of the round pieces are vertices. False, with nothing changed, where the facets are the contact:
/// neither is round, both are so by their facets alone, a cylinder stands on its end or its rim meets an
/// edge, or an axis or centre is inside the other piece.
bool meet_round(const RoundSide& a, const RoundSide& b, const Pose& X_AB, double margin, PairDistance& found,
                StaticVector<ContactPoint, Manifold::kMostPoints>& points) noexcept;

}  // namespace tactum::inline v0_1
