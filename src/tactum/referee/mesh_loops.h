#pragma once
/// Closed lines along the edges of a surface, such that every other one can be drawn together, on the
/// surface, to a sum of them [Eppstein 2003]. A ring has two, one round its wire and one along it; a sphere
/// has none; an open sheet has its rim.
///
/// How often these lines go through those of another surface cannot change unless the surfaces cross
/// (linking.h).

#include <vector>

#include "tactum/geometry/triangle_mesh.h"

namespace tactum::inline v0_1 {

using ClosedLine = std::vector<Vec3>;  ///< corners in order, the last one joined to the first [m]

/// The loops of a mesh whose equal corners are one (weld.h). A tree of edges reaches every vertex, a second
/// tree crosses from triangle to triangle over edges that are not in it; each edge that is in neither closes
/// a loop. Those of fewer than three corners are left out.
std::vector<ClosedLine> mesh_loops(const TriangleMesh& mesh);

}  // namespace tactum::inline v0_1
