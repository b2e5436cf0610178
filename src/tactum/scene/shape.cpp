#include "tactum/scene/shape.h"

#include <utility>

#include "tactum/mesh/round_part.h"

namespace tactum::inline v0_1 {
namespace {

Result<Part> built(const Shape& shape, double density_kg_per_m3) {
  PartOptions options;
  options.name = shape.file;
  options.density_kg_per_m3 = density_kg_per_m3;
  options.about_center_of_mass = true;
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

}  // namespace

Result<std::shared_ptr<const Part>> part_of(const Shape& shape, double density_kg_per_m3) {
  if (shape.prepared != nullptr) {
    PartFile file = *shape.prepared;
    set_density(file, density_kg_per_m3);
    file.part.origin = file.origin;
    return std::shared_ptr<const Part>(std::make_shared<Part>(std::move(file.part)));
  }
  Result<Part> part = built(shape, density_kg_per_m3);
  if (!part) return part.error();
  return std::shared_ptr<const Part>(std::make_shared<Part>(std::move(*part)));
}

}  // namespace tactum::inline v0_1
