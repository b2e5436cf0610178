#pragma once
/// Triangles without area whose middle corner lies on their longest side ("caps", T-joints): the corner is
/// given to the neighbour across that side, which is cut there, and the cap is gone. At an open side the cap
/// is just dropped. Picture in mesh_repair.h.
///
/// Surfaces keep their shape to kDegenerateTriangle of the cap's length. Caps whose neighbour is ambiguous
/// (more than two triangles at the side, or the cut would need an edge that is there already) stay. Rounds of
/// n log n, at most kMostCapRounds: a fan of caps is undone from its rim inward.

#include <vector>

#include "tactum/geometry/triangle_mesh.h"

namespace tactum::inline v0_1 {

inline constexpr int kMostCapRounds = 16;

struct CapReport {
  std::vector<int> mended;  ///< triangles that had no area and were given to a neighbour or dropped
  std::vector<int> left;    ///< ... that stay
};

/// Numbers in the report are those of `source`, which is kept in step with the triangles.
CapReport mend_caps(TriangleMesh& mesh, std::vector<int>& source);

}  // namespace tactum::inline v0_1
