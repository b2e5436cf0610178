#pragma once
/// Components that are open at edges of more than two triangles, and close together:
///
///        +-----+-----+     Two solids that meet in a face are four patches: two shells open at the rim of
///        |     |     |     the face, and the two walls. Each shell with its wall is a solid, but which wall
///        |     |     |     is whose cannot be told at an edge of four. All four together have an even number
///        +-----+-----+     of triangles at every edge, so they bound a volume.

#include <vector>

#include "tactum/geometry/mesh_edges.h"
#include "tactum/repair/mesh_components.h"

namespace tactum::inline v0_1 {

/// Makes one component of each such set, and turns its patches: as in the file when that bounds a volume,
/// else by the parity of crossings along a ray. `turned` are the triangles that stand against the mesh given,
/// `out` the components as edges of two triangles make them, with their open edges found. n log n, and for
/// what the file does not orient a ray for each triangle (surface_crossings.h).
void join_open_patches(const TriangleMesh& mesh, const std::vector<HalfEdge>& sides,
                       std::vector<bool>& turned, OrientedMesh& out, int threads = 1);

}  // namespace tactum::inline v0_1
