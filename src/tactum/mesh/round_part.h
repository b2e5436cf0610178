#pragma once
/// Balls and cylinders as parts. In contact their surfaces are exact (contact/round_contact.h), and mass and
/// inertia are those of the true solids. Facets inside of the surface, whose number changes neither, are what
/// is drawn and what the search for contacts walks on.

#include "tactum/mesh/make_part.h"

namespace tactum::inline v0_1 {

/// A sphere, or a cylinder with its axis along z, about the origin, with its facets.
struct RoundSolid {
  Polytope facets;     ///< [m]
  RoundPiece surface;  ///< its bulge is not read
};

/// The facets are an icosahedron's, divided `subdivisions` times.
RoundSolid make_ball(double radius_m, int subdivisions);
/// The facets are a prism's of so many `sides`, at least 3.
RoundSolid make_cylinder(double radius_m, double height_m, int sides);

/// The part of a ball or cylinder. Errors are those of part_from_clouds(); `options.scale` must be 1.
Result<Part> round_part(const RoundSolid& solid, const PartOptions& options = {});

}  // namespace tactum::inline v0_1
