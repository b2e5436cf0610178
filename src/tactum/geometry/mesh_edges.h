#pragma once
/// The edges of a triangle mesh with the triangles at each, sorted: the basis of every topological query.

#include <algorithm>
#include <vector>

#include "tactum/geometry/triangle_mesh.h"

namespace tactum::inline v0_1 {

/// One side of one triangle. Sides of the same edge stand together when sorted.
struct HalfEdge {
  int low = 0, high = 0;  ///< the vertices, low < high
  int triangle = 0;
  int corner = 0;        ///< the side from this corner of the triangle to the next
  bool forward = false;  ///< the triangle runs low -> high

  bool same_edge(const HalfEdge& other) const { return low == other.low && high == other.high; }
};

/// All sides, sorted by edge, then triangle. The triangles must have three different corners.
std::vector<HalfEdge> sorted_half_edges(const TriangleMesh& mesh);

/// Calls visit(first, last) for the sides of each edge.
template <class Visitor>
void for_each_edge(const std::vector<HalfEdge>& sides, Visitor&& visit) {
  for (std::size_t first = 0; first < sides.size();) {
    std::size_t last = first + 1;
    while (last < sides.size() && sides[last].same_edge(sides[first])) ++last;
    visit(sides.data() + first, sides.data() + last);
    first = last;
  }
}

/// Sets of numbers that are joined pair by pair (union-find with path halving).
class DisjointSets {
 public:
  explicit DisjointSets(int count) : parent_(static_cast<std::size_t>(count)) {
    for (int i = 0; i < count; ++i) parent_[i] = i;
  }
  int find(int i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  /// The lower root stays root, so the numbers of sets do not depend on the order of joining.
  void join(int a, int b) {
    a = find(a);
    b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<int> parent_;
};

}  // namespace tactum::inline v0_1
