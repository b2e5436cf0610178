#pragma once
/// The overlap of convex pieces, by every separating axis there is: the directions are gathered once,
/// parallel ones count once. Shares no code with the contact queries.

#include <vector>

#include "tactum/geometry/polytope.h"
#include "tactum/math/pose.h"

namespace tactum::bench {

/// A piece as corners, normals of faces and directions of edges, in a frame of the caller's.
struct OverlapPiece {
  std::vector<Vec3> corners, normals, directions;  ///< parallel ones left out
};

OverlapPiece overlap_piece(const Polytope& P, const Pose& X);

/// The least depth over all axes; 0 when some axis separates them. Both are given in one frame [m].
double overlap(const OverlapPiece& a, const OverlapPiece& b);

/// The piece carried to X.
OverlapPiece carried(const OverlapPiece& piece, const Pose& X);

}  // namespace tactum::bench
