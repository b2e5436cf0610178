#pragma once
/// How far the pieces of a part are from the mesh they were made of, in both directions: a check of
/// preparation, by code that has nothing in common with it.
///
///   mesh -> part   corners, middles of sides and a grid over every triangle of the mesh, each to the nearest
///                  point of the pieces' faces
///   part -> mesh   the same of the pieces' faces to the mesh; a sample on or in another solid piece is on a
///                  cut of ours inside the solid, not on the surface, and is only counted
///
/// The grid is finer on larger triangles. A part without pieces is
/// judged by its surface. Under trees of boxes: n log n, about two microseconds a sample. The search for a
/// sample ends as soon as it is known to be no farther than another: samples on the other surface, which are
/// nearly all, end at the first triangle that holds them.

#include <vector>

#include "tactum/geometry/bvh.h"
#include "tactum/geometry/part.h"
#include "tactum/geometry/triangle_mesh.h"

namespace tactum::inline v0_1 {

inline constexpr int kAreaSamples = 4000;

/// Nearest points of a mesh's triangles. The mesh must outlive it.
class NearestOnMesh {
 public:
  explicit NearestOnMesh(const TriangleMesh& mesh, int threads = 1);

  /// Distance from the point [m]; 1e300 from no triangle. The triangle `nearest`, which may be any, and the
  /// one after it are tested first; it becomes the one found. The search ends at a distance of at most
  /// `near_enough` [m]: such a distance is an upper bound, a larger one is exact.
  double distance(const Vec3& point, int& nearest, double near_enough = 0.0) const;

 private:
  double to_triangle_sq(int triangle, const Vec3& point) const;

  const TriangleMesh& mesh_;
  Bvh tree_;
};

struct Deviation {
  double mesh_to_part = 0.0;          ///< largest distance of a sample of the mesh from the part [m]
  double part_to_mesh = 0.0;          ///< ... of a sample of the part's surface from the mesh [m]
  Vec3 worst_on_mesh = Vec3::Zero();  ///< where, in the frame of the mesh [m]
  Vec3 worst_on_part = Vec3::Zero();  ///< where, in the frame of the mesh [m]
  int mesh_samples = 0;
  int part_samples = 0;
  int inner_samples = 0;  ///< of part_samples: on cuts inside the solid
  double size = 0.0;      ///< of the mesh: the diagonal of its box [m]

  double largest() const { return mesh_to_part > part_to_mesh ? mesh_to_part : part_to_mesh; }
};

/// The faces of a part's pieces as triangles, relative to `origin` in the mesh's frame; the surface itself
/// when it has no pieces. `piece` gets the piece of each triangle.
TriangleMesh faces_of(const Part& part, const Vec3& origin, std::vector<int>& piece);

/// `origin`: where the part's frame stands in the mesh's [m].
/// `area_samples`: of the grid over either surface, about. The same for any number of threads.
Deviation surface_deviation(const TriangleMesh& mesh, const Part& part, const Vec3& origin = Vec3::Zero(),
                            int area_samples = kAreaSamples, int threads = 1);

}  // namespace tactum::inline v0_1
