#pragma once
/// Triangles of the same three corners, however they face. What stands twice in a file means one of three
/// things, told apart by the other triangles at the rim of what stands twice:
///
///    a copy                      a wall                       a sheet
///    ___====____                 +------+------+              ______________
///    one other triangle at       |      ‖      |              no other, or the copies
///    the rim: without a copy     +------+------+              stand in the open
///    the surface has a hole      two others at the rim,
///                                solid on both sides
///
/// Of a copy and of a sheet one triangle is kept; walls between two solids go, since nothing reaches them.
/// Neither orientation nor the order in the file matters. n log n; where walls and sheets must be told apart,
/// also the cost of orientation (mesh_orientation.h) and a ray for each patch.

#include <vector>

#include "tactum/geometry/triangle_mesh.h"

namespace tactum::inline v0_1 {

/// Numbers of triangles in the mesh given, in ascending order.
struct RepeatedTriangles {
  std::vector<int> copies;  ///< they repeat another one, which is kept
  std::vector<int> walls;   ///< both sides of walls inside a solid: none is kept
  std::vector<int> sheets;  ///< the second sides of sheets; the first is kept
};

/// The mesh is welded, and its triangles have three different corners.
RepeatedTriangles find_repeated_triangles(const TriangleMesh& mesh, int threads = 1);

}  // namespace tactum::inline v0_1
