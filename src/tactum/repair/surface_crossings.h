#pragma once
/// The winding number of closed surfaces about a point, from the crossings of a ray, for each surface apart.
///
/// The ray runs along +x, so a crossing is a point in a triangle of the yz plane, and the test there is
/// half-open in z: an edge that two triangles share is crossed by exactly one of them, whatever the rounding,
/// because both compute it from the same ends in the same order. No ray slips between two triangles, and none
/// is counted twice at a vertex. O(log n + crossings) a ray.

#include <utility>
#include <vector>

#include "tactum/geometry/bvh.h"
#include "tactum/geometry/triangle_mesh.h"

namespace tactum::inline v0_1 {

class SurfaceCrossings {
 public:
  /// Of the mesh as it stands; `surface[t]` names the surface of triangle t, -1: left out.
  SurfaceCrossings(const TriangleMesh& mesh, const std::vector<int>& surface, int threads = 1);

  /// (surface, winding number) of all surfaces that wind about the point, in ascending order: +1 inside one
  /// that faces outward. A point on a surface counts as either side of it.
  std::vector<std::pair<int, int>> windings(const Vec3& point) const;

  /// How many other triangles of its surface a ray from the middle of a triangle crosses.
  int crossed(const Vec3& middle, int triangle) const;

 private:
  /// Calls visit(triangle, +1 or -1) for every triangle that the ray crosses.
  template <class Visitor>
  void for_each_crossing(const Vec3& point, Visitor&& visit) const;

  /// +1 or -1 where the ray from `point` leaves or enters by the triangle, else 0.
  int crossing(int triangle, const Vec3& point) const;

  const TriangleMesh& mesh_;
  const std::vector<int>& surface_;
  std::vector<int> taken_;  ///< triangles of surfaces that count
  Bvh tree_;                ///< over taken_
};

}  // namespace tactum::inline v0_1
