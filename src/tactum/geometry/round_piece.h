#pragma once
/// The sphere or cylinder that a convex piece stands for. Its corners lie on the curved surface, so the
/// facets are inside of it: contacts are found by these, and are then those of the curved surface
/// (contact/round_contact.h).
///
///       _..---.._     curved surface
///     .'_________'.   facet: at most `bulge_m` inside of it
///     /           \.

#include "tactum/geometry/polytope.h"
#include "tactum/geometry/triangle_mesh.h"

namespace tactum::inline v0_1 {

enum class RoundKind : std::uint8_t {
  kNone,      ///< the facets are the surface
  kSphere,    ///<
  kCylinder,  ///< with two flat ends
};

struct RoundPiece {
  RoundKind kind = RoundKind::kNone;
  Vec3 center = Vec3::Zero();  ///< frame of the piece [m]
  Vec3 axis = Vec3::UnitZ();   ///< of a cylinder, unit [-]
  double radius_m = 0.0;       ///< [m]
  double half_length_m = 0.0;  ///< of a cylinder [m]
  bool made = false;           ///< as a ball or cylinder; false: recognised in the facets
  double bulge_m = 0.0;        ///< greatest distance of the curved surface from the facets [m]
};

/// The sphere or cylinder whose surface all corners of the piece lie on, when facets that meet at less than
/// `crease_rad` are parts of one curved surface: kNone where two facets, of a cylinder two sides, meet at
/// more.
RoundPiece find_round_piece(const Polytope& piece, double crease_rad);

/// The ball whose facets the triangles of a welded mesh are, all of them; kNone where they are not.
RoundPiece find_ball(const TriangleMesh& mesh, double crease_rad);

}  // namespace tactum::inline v0_1
