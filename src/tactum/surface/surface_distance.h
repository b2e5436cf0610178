#pragma once
/// Exact distance of two triangle surfaces at any pose, and how many of their triangles touch.
///
/// Branch and bound over two trees of boxes: nearer boxes first, boxes no nearer than the best pair so far
/// are left out. The pair that was nearest last time gives the first bound and its neighbourhood is tested
/// first, so that along a motion little but the surroundings of the contact is tested. When surfaces cross,
/// the distance is zero and a second walk counts the touching pairs. A surface wholly inside another is free:
/// the query is one of surfaces, not of solids.
///
/// Queries are noexcept, allocate nothing and give the same bits for the same input.

#include <vector>

#include "tactum/geometry/bvh.h"
#include "tactum/geometry/triangle_mesh.h"
#include "tactum/math/pose.h"
#include "tactum/surface/triangle_pair.h"

namespace tactum::inline v0_1 {

/// The triangles of a surface under a tree of boxes, as they stand in the mesh: no welding, none left out.
class Surface {
 public:
  explicit Surface(const TriangleMesh& mesh);

  const Bvh& bvh() const noexcept { return bvh_; }
  const TrianglePoints& triangle(int index) const noexcept {
    return triangles_[static_cast<std::size_t>(index)];
  }
  int count() const noexcept { return static_cast<int>(triangles_.size()); }
  double size() const noexcept { return size_; }  ///< diagonal of the bounding box [m]

 private:
  std::vector<TrianglePoints> triangles_;
  double size_ = 0.0;
  Bvh bvh_;
};

/// The nearest triangles of the last query on a pair; -1: none yet.
struct SurfacePairCache {
  int triangle_a = -1;
  int triangle_b = -1;
};

struct SurfaceDistance {
  double distance = 0.0;    ///< zero when they touch or cross [m]
  int touching_pairs = 0;   ///< pairs of triangles with a common point; 1 for any when not counted
  Vec3 p_a = Vec3::Zero();  ///< nearest point on A, A's frame [m]
  Vec3 p_b = Vec3::Zero();  ///< nearest point on B, A's frame [m]
  int triangle_a = -1;      ///< the nearest triangles; when touching, the first pair found
  int triangle_b = -1;
  long boxes_tested = 0;      ///< work done
  long triangles_tested = 0;  ///< work done
};

/// Whether all touching pairs are counted, which costs a second walk, or the first one found is the answer.
enum class TouchingPairs { kCounted, kFirst };

/// Distance of A and B with B at X_AB. Two surfaces without triangles are infinitely far apart (1e300).
SurfaceDistance surface_distance(const Surface& a, const Surface& b, const Pose& X_AB,
                                 SurfacePairCache& cache,
                                 TouchingPairs touching = TouchingPairs::kCounted) noexcept;

}  // namespace tactum::inline v0_1
