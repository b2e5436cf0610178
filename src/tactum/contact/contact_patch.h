#pragma once
/// A contact patch of two bodies, as the contact finder emits it.

#include <algorithm>

#include "tactum/base/tolerances.h"
#include "tactum/collision/contact.h"

namespace tactum::inline v0_1 {

/// The facets of A and of B that a patch lies on, each -1 where it lies on none: groups of the surface, see
/// SurfaceGroups. Patches of the same bodies and facets touch on the same two walls: they have one stiffness
/// together.
struct FacetPair {
  int a = -1, b = -1;
};

/// Of each body: an edge or corner of it touches on another piece; the feature, if any, is the face beside it
/// on this one.
struct NeighbourFaces {
  bool a = false, b = false;
};

/// The two bodies that touch, and which of their pieces.
struct PatchSides {
  int body_a = -1, body_b = -1;    ///< body_a < body_b
  int piece_a = -1, piece_b = -1;  ///< within their parts; triangles where two surfaces meet
  int pair = -1;                   ///< of pieces, in the finder's list
};

/// Two pieces nearer than their tolerance, or two triangles of surfaces with a local minimum of their
/// distance. Manifold in A's body frame.
struct ContactPatch : PatchSides {
  bool of_surfaces = false;  ///< the features of the manifold are those of SurfaceTree
  bool met = false;          ///< of two triangles that met where no minimum of the distance stood for them
  NeighbourFaces neighbour_face;
  bool round = false;    ///< its points are those of curved surfaces (round_contact.h); without any: watched
  bool implied = false;  ///< by a contact with another body (flush_bodies.h): it has no force of its own
  FacetPair facets;
  double distance = 0.0;   ///< of the pieces, or of the local minimum; negative when they overlap [m]
  double tolerance = 0.0;  ///< delta, the contact margin of the pair of bodies [m]
  Manifold manifold;

  /// What is carried from frame to frame (carried_state.h).
  template <class Self, class Visit>
  static void carried(Self& self, Visit& visit) noexcept {
    visit(self.body_a, self.body_b, self.piece_a, self.piece_b, self.pair, self.of_surfaces, self.met,
          self.neighbour_face, self.round, self.implied, self.facets, self.distance, self.tolerance,
          self.manifold);
  }
};

/// A patch's weight in its facet's stiffness: its area; for a segment its length times a very small width,
/// for a point almost nothing, both small beside any area [m^2].
inline double patch_weight(const Manifold& manifold) noexcept {
  if (manifold.area > 0.0) return manifold.area;
  if (manifold.points.size() < 2) return tolerances::kPointArea_m2;
  const double length = (manifold.points[1].p_a - manifold.points[0].p_a).norm();
  return std::max(length * tolerances::kLineWidth_m, tolerances::kLeastWeight_m2);
}

}  // namespace tactum::inline v0_1
