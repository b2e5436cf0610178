#pragma once
/// Walls that a file holds once between the rooms of one solid:
///
///        +-----+-----+     Three triangles meet at each edge of the wall's rim, so neither the outside nor a
///        |  1  |  2  |     room is closed by itself. The sides of the triangles are joined around every edge
///        |     |     |     into the regions that they bound: 1, 2 and the outside. A triangle with a room on
///        +-----+-----+     either side is such a wall. Nothing reaches it; without it the rest is closed.
///
/// A sheet that hangs inside a room is a wall too; one that stands off the solid outside is none, and stays.

#include <vector>

#include "tactum/geometry/triangle_mesh.h"

namespace tactum::inline v0_1 {

/// Numbers of the triangles of such walls, in ascending order: of those sets of triangles, joined over edges,
/// that have an edge of three, five, ... triangles, and that are closed without their walls. The mesh is
/// welded, no triangle stands twice, and each has three different corners. Neither orientation nor order
/// matters. n log n.
std::vector<int> find_inner_walls(const TriangleMesh& mesh);

}  // namespace tactum::inline v0_1
