#pragma once
/// The inside of a mesh's solids, for what is nowhere near their surface: a mesh that lies wholly in another.

#include <vector>

#include "tactum/math/pose.h"
#include "tactum/repair/mesh_repair.h"
#include "tactum/repair/surface_crossings.h"

namespace tactum::inline v0_1 {

class MeshInterior {
 public:
  /// Of the mesh as repair_mesh() sees it: closed components count, cavities are outside. n log n.
  explicit MeshInterior(const TriangleMesh& mesh);
  MeshInterior(const MeshInterior&) = delete;
  MeshInterior& operator=(const MeshInterior&) = delete;

  /// Whether the point lies in a solid of the mesh; at its surface either answer may come. O(log n).
  bool contains(const Vec3& point) const { return !crossings_.windings(point).empty(); }

  /// A corner of each component, open ones too.
  const std::vector<Vec3>& corners() const { return corners_; }

 private:
  RepairedMesh repaired_;
  std::vector<int> surface_;  ///< 0 for triangles of closed components, else -1
  SurfaceCrossings crossings_;
  std::vector<Vec3> corners_;
};

/// Whether a component of either mesh lies in a solid of the other. The surfaces must not touch.
bool one_inside_other(const MeshInterior& a, const MeshInterior& b, const Pose& X_AB);

}  // namespace tactum::inline v0_1
