#include "tactum/scene/shape.h"

#include <algorithm>
#include <utility>

#include "tactum/mesh/round_part.h"

namespace tactum::inline v0_1 {
namespace {

Result<Part> built(const Shape& shape, double density_kg_per_m3, const InertialDescription* inertial) {
  PartOptions options;
  options.name = shape.file;
  options.density_kg_per_m3 = density_kg_per_m3;
  options.about_center_of_mass = true;
  if (inertial != nullptr) options.origin = inertial->center_m;
  if (shape.stands_for.kind != RoundKind::kNone)
    return round_part({shape.pieces[0], shape.stands_for}, options);
  if (!shape.pieces.empty()) {
    std::vector<std::vector<Vec3>> clouds;
    for (const Polytope& piece : shape.pieces) clouds.push_back(piece.vertices);
    return part_from_clouds(clouds, options);
  }
  options.pieces = shape.piece_source;
  return shape.given ? part_from_convex_groups(shape.mesh, options)
                     : part_from_mesh(shape.mesh.mesh, options);
}

/// The part as it stands about the stated centre, with the stated mass.
void state_mass(const InertialDescription& inertial, Part& part) {
  std::erase(part.notes.remarks, part.mass.approximation);  // of a mass that is not used
  part.mass.mass = inertial.mass_kg;
  part.mass.center = Vec3::Zero();
  part.mass.inertia = inertial.tensor();
  part.mass.approximation.clear();
  part.radius = 0.0;
  for (const Vec3& vertex : part.surface.vertices) part.radius = std::max(part.radius, vertex.norm());
}

}  // namespace

Result<std::shared_ptr<const Part>> part_of(const Shape& shape, double density_kg_per_m3,
                                            const InertialDescription* inertial) {
  if (shape.prepared != nullptr && inertial != nullptr)
    return Error{"a prepared part has its own centre of mass", "inertial",
                 "mass_kg or density_kg_per_m3, or the mesh it was made from", shape.file};
  if (shape.prepared != nullptr) {
    PartFile file = *shape.prepared;
    set_density(file, density_kg_per_m3);
    file.part.origin = file.origin;
    return std::shared_ptr<const Part>(std::make_shared<Part>(std::move(file.part)));
  }
  Result<Part> part = built(shape, density_kg_per_m3, inertial);
  if (!part) return part.error();
  if (inertial != nullptr) state_mass(*inertial, *part);
  return std::shared_ptr<const Part>(std::make_shared<Part>(std::move(*part)));
}

}  // namespace tactum::inline v0_1
