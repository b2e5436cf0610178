#include "tactum/geometry/mesh_edges.h"

#include <algorithm>
#include <tuple>

namespace tactum::inline v0_1 {

std::vector<HalfEdge> sorted_half_edges(const TriangleMesh& mesh) {
  std::vector<HalfEdge> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (int corner = 0; corner < 3; ++corner) {
      const int from = mesh.triangles[i][corner];
      const int to = mesh.triangles[i][(corner + 1) % 3];
      sides.push_back({std::min(from, to), std::max(from, to), static_cast<int>(i), corner, from < to});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const HalfEdge& a, const HalfEdge& b) {
    return std::tie(a.low, a.high, a.triangle, a.corner) < std::tie(b.low, b.high, b.triangle, b.corner);
  });
  return sides;
}

}  // namespace tactum::inline v0_1
