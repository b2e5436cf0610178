#pragma once
/// The walk over the facets of the Minkowski difference N = { b - a : a in A, b in B }, in A's frame.
///
/// N is never built. Its facets are pairs of features whose normals meet when both Gauss maps are laid over
/// each other:
///
///     face of A, vertex of B       n = -normal of the face          a node of A's map inside a cell of B's
///     vertex of A, face of B       n =  normal of the face          a node of B's map inside a cell of A's
///     edge of A, edge of B         n =  +-(edge x edge)             a crossing of two arcs
///
/// The pieces overlap when the origin is inside N; moving A by t puts it at b - a = t. So moving A by h along
/// n takes the origin to the plane of a facet of height h = n . (b - a); and the shortest translation that
/// separates the pieces ends on the facet that holds the foot of its own plane. Where the foot lies beyond a
/// border of the facet, the plane of the neighbour across it is nearer: the walk goes there. The same walk
/// with "where the ray leaves the plane" in place of the foot finds the depth along a given direction. (It
/// continues the walk of closest features inside, after the pseudo-internal Voronoi regions of [Ponamgi
/// 1997]; the facets are found on the fly, not stored.) Cost: about 60 ns a facet.

#include <cmath>

#include "tactum/collision/pair_view.h"

namespace tactum::inline v0_1 {

/// A facet of N.
struct MinkowskiFacet {
  Feature a, b;
  Vec3 n = Vec3::Zero();  ///< outward from N: from B to A, unit, A's frame
  double height = 0.0;    ///< n . (b - a): how far A must move along n to be clear [m]
};

/// Whether the features of the facet lie in the support planes across its normal. Certain for a facet of a
/// face, whose vertex was climbed to. Two edges do where the normal is in both their cones, since a convex
/// polytope has no other local maxima than its supports.
bool is_real(const PairView& pair, const MinkowskiFacet& facet) noexcept;

/// The outcome of a walk.
struct MinkowskiWalk {
  MinkowskiFacet facet;
  Vec3 p_a = Vec3::Zero();  ///< witness points on the features of the facet, A's frame [m]
  Vec3 p_b = Vec3::Zero();
  double outside = 0.0;  ///< how far the witness points lie outside their features [m]
  int steps = 0;
  bool settled = false;  ///< it ended by itself, not at a bound on its moves

  /// Whether it is at a local minimum of the depth, with proof: the facet is real and holds its foot.
  bool arrived(const PairView& pair) const noexcept {
    return outside <= tolerances::kCertificate * pair.size && std::isfinite(facet.height) &&
           is_real(pair, facet);
  }
};

/// The facet of a face of A (`on_a`) or of B, with the other piece's support vertex climbed to from `vertex`.
MinkowskiFacet facet_of_face(const PairView& pair, bool on_a, int face, int vertex) noexcept;

/// The facet where two edges' arcs cross; false when they do not.
bool facet_of_edges(const PairView& pair, int edge_a, int edge_b, MinkowskiFacet& facet) noexcept;

/// A facet near the outward direction `n` (any length): that of the best aligned face at either support
/// vertex.
MinkowskiFacet facet_near(const PairView& pair, const Vec3& n) noexcept;

/// The same, climbing from vertices that are near.
MinkowskiFacet facet_near(const PairView& pair, const Vec3& n, int from_a, int from_b) noexcept;

/// Less near, with one climb instead of three: by the best aligned face at the vertices in the direction
/// table.
MinkowskiFacet facet_toward(const PairView& pair, const Vec3& n) noexcept;

/// The witness points on a facet itself, without a walk.
MinkowskiWalk stand_on(const PairView& pair, const MinkowskiFacet& facet) noexcept;

/// Walks from `start` to the facet that holds its own foot: a local minimum of the depth, and not above those
/// behind its nearest borders.
MinkowskiWalk walk_to_foot(const PairView& pair, const MinkowskiFacet& start) noexcept;

/// Walks from `start` to the first facet that holds its own foot, also where the next one is lower: it may
/// become the lowest before that one. After `most_moves` it stops where it is, not `settled`.
MinkowskiWalk walk_to_any_foot(const PairView& pair, const MinkowskiFacet& start, int most_moves) noexcept;

/// Walks from `start` to the facet where the ray along unit `direction` leaves N; start.n . direction > 0.
MinkowskiWalk walk_along_ray(const PairView& pair, const MinkowskiFacet& start,
                             const Vec3& direction) noexcept;

}  // namespace tactum::inline v0_1
