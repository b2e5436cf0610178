#include "tactum/geometry/mesh_edges.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <tuple>

namespace tactum::inline v0_1 {

std::vector<HalfEdge> sorted_half_edges(const TriangleMesh& mesh) {
  // By the lower vertex into places counted before, then the few at each vertex.
  std::vector<std::size_t> first(mesh.vertices.size() + 1, 0);
  for (const Triangle& t : mesh.triangles)
    for (int corner = 0; corner < 3; ++corner) ++first[std::min(t[corner], t[(corner + 1) % 3]) + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<HalfEdge> sides(3 * mesh.triangles.size());
  std::vector<std::size_t> next(first.begin(), first.end() - 1);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (int corner = 0; corner < 3; ++corner) {
      const int from = mesh.triangles[i][corner];
      const int to = mesh.triangles[i][(corner + 1) % 3];
      const int low = std::min(from, to);
      sides[next[low]++] = {low, std::max(from, to), static_cast<int>(i), corner, from < to};
    }
  }
  const auto at = [&](std::size_t i) { return sides.begin() + static_cast<std::ptrdiff_t>(i); };
  for (std::size_t vertex = 0; vertex + 1 < first.size(); ++vertex)
    std::sort(at(first[vertex]), at(first[vertex + 1]), [](const HalfEdge& a, const HalfEdge& b) {
      return std::tie(a.high, a.triangle, a.corner) < std::tie(b.high, b.triangle, b.corner);
    });
  return sides;
}

}  // namespace tactum::inline v0_1
