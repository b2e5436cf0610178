#pragma once
/// Which triangles of a mesh lie in one plane: the flat faces that a file stores in triangles.

#include <vector>

#include "tactum/geometry/triangle_mesh.h"

namespace tactum::inline v0_1 {

/// The group of each triangle: connected triangles in one plane, to the tolerances kCoplanarMeshSine and
/// kCoplanarMeshOffset. Groups grow from the largest triangles, whose planes are known best. Numbered from 0.
std::vector<int> coplanar_groups(const TriangleMesh& welded);

}  // namespace tactum::inline v0_1
