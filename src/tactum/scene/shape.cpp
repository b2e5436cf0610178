#include "tactum/scene/shape.h"

#include <utility>

#include "tactum/base/assert.h"
#include "tactum/mesh/make_part.h"

namespace tactum {
namespace {

Result<Part> built(const Vec3& origin, const Shape& shape, double density_kg_per_m3) {
  PartOptions options;
  options.name = shape.file;
  options.density_kg_per_m3 = density_kg_per_m3;
  if (!shape.pieces.empty()) {
    std::vector<std::vector<Vec3>> clouds;
    for (const Polytope& piece : shape.pieces) {
      clouds.push_back(piece.vertices);
      for (Vec3& vertex : clouds.back()) vertex -= origin;
    }
    return part_from_clouds(clouds, options);
  }
  options.pieces = shape.piece_source;
  ImportedMesh moved = shape.mesh;
  for (Vec3& vertex : moved.mesh.vertices) vertex -= origin;
  return shape.given ? part_from_convex_groups(moved, options) : part_from_mesh(moved.mesh, options);
}

}  // namespace

Result<Vec3> centre_of_mass(const Shape& shape) {
  if (shape.prepared != nullptr) return shape.prepared->origin;
  // A mesh of a million triangles is not made a part twice for this.
  if (shape.pieces.empty() && !shape.given) return mass_properties_or_hull(shape.mesh.mesh, 1.0).center;
  const Result<Part> part = built(Vec3::Zero(), shape, 1.0);
  if (!part) return part.error();
  return part->mass.center;
}

Result<std::shared_ptr<const Part>> part_about(const Vec3& origin, const Shape& shape,
                                               double density_kg_per_m3) {
  if (shape.prepared != nullptr) {
    TACTUM_DEMAND(origin == shape.prepared->origin);
    PartFile file = *shape.prepared;
    set_density(file, density_kg_per_m3);
    return std::shared_ptr<const Part>(std::make_shared<Part>(std::move(file.part)));
  }
  Result<Part> part = built(origin, shape, density_kg_per_m3);
  if (!part) return part.error();
  return std::shared_ptr<const Part>(std::make_shared<Part>(std::move(*part)));
}

}  // namespace tactum
