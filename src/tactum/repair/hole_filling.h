#pragma once
/// Holes of a surface closed with triangles between the corners of their rims; no new vertex.
///
///     o-----o          The rim is a loop of open edges. Among all its triangulations the one of least area
///    / hole  \         is taken [Barequet and Sharir 1995]: exact for flat holes, sensible for bent ones;
///   o         o        a crack (a rim that encloses nothing) gets triangles without area, which repair
///    \-------/         then gives to their neighbours. O(n^3) for a rim of n edges.
///
/// A crack is closed always, up to kMostRimEdges: rim corners in the middle of other triangles' edges, which
/// coarse and fine tessellations of neighbouring faces leave. Loops that meet in a vertex are rims of their
/// own. A rim that does not come back to its beginning, or that no triangulation closes without an edge that
/// is there already, is left open.

#include <vector>

#include "tactum/geometry/triangle_mesh.h"

namespace tactum::inline v0_1 {

inline constexpr int kMostRimEdges = 256;  ///< longer rims are never closed: 256^3 / 6 areas are 3 million

/// A hole is a crack when it is narrower than this fraction of the mesh's size, in the mean along its rim:
/// two micrometres in two centimetres. Files of six decimals in metres put corners a quarter of that beside
/// the edge they lie on.
inline constexpr double kCrackWidth = 0.1e-3;

struct Rim {
  std::vector<int> vertices;  ///< in the order that a triangle closing it would run
  int triangle = -1;          ///< at its first edge
  bool simple = true;         ///< it comes back to its beginning
  bool crack = false;         ///< narrower than kCrackWidth of the mesh's size
  bool closed = false;        ///< filled
};

/// The rims of the mesh's holes. Where triangles of one rim disagree in orientation, it runs as one of them
/// needs it.
std::vector<Rim> rims_of(const TriangleMesh& mesh);

/// Closes cracks, and rims of at most `most_edges` edges. New triangles are appended; each rim is marked as
/// closed or not.
std::vector<Rim> close_holes(TriangleMesh& mesh, int most_edges);

}  // namespace tactum::inline v0_1
