#include "tactum/repair/mesh_interior.h"

#include <algorithm>

namespace tactum::inline v0_1 {
namespace {

std::vector<int> closed_surface(const RepairedMesh& repaired) {
  std::vector<int> surface;
  surface.reserve(repaired.component.size());
  for (const int component : repaired.component)
    surface.push_back(repaired.components[component].closed ? 0 : -1);
  return surface;
}

}  // namespace

MeshInterior::MeshInterior(const TriangleMesh& mesh)
    : repaired_(repair_mesh(mesh)),
      surface_(closed_surface(repaired_)),
      crossings_(repaired_.mesh, surface_) {
  for (const MeshComponent& component : repaired_.components)
    corners_.push_back(repaired_.mesh.vertices[repaired_.mesh.triangles[component.first_triangle][0]]);
}

bool one_inside_other(const MeshInterior& a, const MeshInterior& b, const Pose& X_AB) {
  const Pose X_BA = X_AB.inverse();
  return std::any_of(b.corners().begin(), b.corners().end(),
                     [&](const Vec3& corner) { return a.contains(X_AB * corner); }) ||
         std::any_of(a.corners().begin(), a.corners().end(),
                     [&](const Vec3& corner) { return b.contains(X_BA * corner); });
}

}  // namespace tactum::inline v0_1
