#include "tactum/mesh/round_part.h"

#include <algorithm>
#include <cmath>

#include "tactum/geometry/primitives.h"

namespace tactum::inline v0_1 {
namespace {

/// Of the true solid, about its centre.
void set_mass(const RoundPiece& surface, double density_kg_per_m3, MassProperties& mass) {
  const double r_sq = surface.radius_m * surface.radius_m;
  const double height = 2.0 * surface.half_length_m;
  const bool ball = surface.kind == RoundKind::kSphere;
  const double across = 0.25 * r_sq + height * height / 12.0;
  const Vec3 gyration_sq_m2 = ball ? Vec3::Constant(0.4 * r_sq) : Vec3(across, across, 0.5 * r_sq);
  mass.volume = ball ? 4.0 / 3.0 * kPi * r_sq * surface.radius_m : kPi * r_sq * height;
  mass.mass = density_kg_per_m3 * mass.volume;
  mass.inertia = (mass.mass * gyration_sq_m2).asDiagonal();
}

}  // namespace

RoundSolid make_ball(double radius_m, int subdivisions) {
  return {make_icosphere(subdivisions, radius_m), {.kind = RoundKind::kSphere, .radius_m = radius_m}};
}

RoundSolid make_cylinder(double radius_m, double height_m, int sides) {
  return {make_prism(sides, radius_m, height_m),
          {.kind = RoundKind::kCylinder, .radius_m = radius_m, .half_length_m = 0.5 * height_m}};
}

Result<Part> round_part(const RoundSolid& solid, const PartOptions& options) {
  Result<Part> part = part_from_clouds({solid.facets.vertices}, options);
  if (!part) return part;
  RoundPiece surface = solid.surface;
  surface.center = -part->origin;
  for (const Polytope::Face& face : part->pieces[0].faces) {
    const bool end = surface.kind == RoundKind::kCylinder && std::abs(face.normal.z()) > 0.5;
    const double depth = face.offset - face.normal.dot(surface.center);
    if (!end) surface.bulge_m = std::max(surface.bulge_m, surface.radius_m - depth);
  }
  surface.made = true;
  part->groups.rounds = {surface};
  part->mass.center = surface.center;
  set_mass(surface, options.density_kg_per_m3, part->mass);
  return part;
}

}  // namespace tactum::inline v0_1
