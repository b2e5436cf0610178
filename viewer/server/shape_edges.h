#pragma once
/// The drawn features of a part: the edges where its surface bends, and the triangles that lie on its
/// surface. Each edge of solid pieces is judged by the shape of the whole part about it, between any two
/// places along it where a piece begins or ends:
///
///               |
///        wall   |          at s a quarter of the turn about the edge is filled: sharp;
///     ----------r-----s    at r three quarters: reflex, where a wall stands on a floor;
///        floor        |    along the seam between the two half or all of it: not drawn
///
/// Cost: edges times pieces that are near, once a scene.

#include <cstdint>
#include <vector>

#include "tactum/geometry/part.h"

namespace tactum {

enum class EdgeKind : std::uint32_t {
  kSharp,    ///< bent outward
  kReflex,   ///< bent inward
  kOpen,     ///< of one triangle: the surface ends here
  kCrowded,  ///< of more than two triangles
};

struct DrawnEdge {
  Vec3 tail, head;  ///< in the part's frame [m]
  EdgeKind kind = EdgeKind::kSharp;
};

/// Edges that bend by more than kDrawnBend_rad, and those that do not join two triangles.
std::vector<DrawnEdge> edges_to_draw(const Part& part);

/// Of each triangle of the part's surface, in order: whether another piece covers all of it.
std::vector<bool> covered_triangles(const Part& part);

inline constexpr double kDrawnBend_rad = 0.45;      ///< flatter ones are a curved surface's facets
inline constexpr std::size_t kMostDrawn = 200'000;  ///< larger surfaces are drawn as they are

}  // namespace tactum
