#pragma once
/// Which triangles of two surfaces cross: a side of one passes through the inside of the other, by exact
/// signs. Triangles that only touch, or share a plane, do not cross.

#include <array>
#include <vector>

#include "tactum/geometry/bvh.h"
#include "tactum/geometry/triangle_mesh.h"

namespace tactum::inline v0_1 {

/// A mesh under a tree of boxes.
class CrossingMesh {
 public:
  explicit CrossingMesh(const TriangleMesh& mesh);
  const TriangleMesh& mesh() const noexcept { return mesh_; }
  const Bvh& boxes() const noexcept { return boxes_; }

 private:
  TriangleMesh mesh_;
  Bvh boxes_;
};

/// Whether two triangles cross, exactly for the corners given.
bool cross_exactly(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b);

/// The pairs of triangles of A and B that cross, with B at X_AB, up to `most` of them; its corners are
/// rounded once, when they are brought into A's frame.
std::vector<std::array<int, 2>> crossing_triangles(const CrossingMesh& a, const CrossingMesh& b,
                                                   const Pose& X_AB, std::size_t most);

}  // namespace tactum::inline v0_1
