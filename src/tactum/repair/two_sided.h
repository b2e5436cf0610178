#pragma once
/// Open surfaces with a back. Triangles are felt from the side they face and, at a rim, from beside
/// (surface_tree.h); so an open surface gets its triangles once more, turned round, with corners of their
/// own: front and back together are a sheet without thickness that is felt from everywhere. Closed components
/// stay as they are. Linear.

#include "tactum/repair/mesh_repair.h"

namespace tactum::inline v0_1 {

/// The triangles of `repaired`, and behind them the backs of its open components. Not to be welded: front and
/// back would have edges of four triangles.
TriangleMesh with_backs(const RepairedMesh& repaired);

/// The area of the open components, one side [m^2].
double open_area(const RepairedMesh& repaired);

}  // namespace tactum::inline v0_1
