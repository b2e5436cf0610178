#include "tactum/repair/cap_triangles.h"

#include <algorithm>

#include "tactum/geometry/mesh_edges.h"
#include "tactum/geometry/weld.h"

namespace tactum::inline v0_1 {
namespace {

bool is_cap(const TriangleMesh& mesh, int triangle) {
  const Triangle& t = mesh.triangles[triangle];
  return has_no_area(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]);
}

/// The corner at which the longest side begins.
int longest_side(const TriangleMesh& mesh, const Triangle& t) {
  int longest = 0;
  double length_sq = -1.0;
  for (int i = 0; i < 3; ++i) {
    const double side_sq = (mesh.vertices[t[(i + 1) % 3]] - mesh.vertices[t[i]]).squaredNorm();
    if (side_sq <= length_sq) continue;
    length_sq = side_sq;
    longest = i;
  }
  return longest;
}

/// The sides at an edge, as [first, last) of the sorted ones.
std::pair<const HalfEdge*, const HalfEdge*> sides_at(const std::vector<HalfEdge>& sides, int a, int b) {
  HalfEdge wanted;
  wanted.low = std::min(a, b);
  wanted.high = std::max(a, b);
  const auto [first, last] = std::equal_range(
      sides.begin(), sides.end(), wanted,
      [](const HalfEdge& x, const HalfEdge& y) { return x.low != y.low ? x.low < y.low : x.high < y.high; });
  return {sides.data() + (first - sides.begin()), sides.data() + (last - sides.begin())};
}

/// One round: every cap whose neighbours were not touched in this round. True when something was done.
class CapRound {
 public:
  CapRound(TriangleMesh& mesh, std::vector<int>& source)
      : mesh_(mesh),
        source_(source),
        sides_(sorted_half_edges(mesh)),
        touched_(mesh.triangles.size(), false) {}

  /// Numbers of the caps mended and those to be dropped.
  void run(std::vector<int>& mended, std::vector<bool>& dropped) {
    for (int t = 0; t < static_cast<int>(mesh_.triangles.size()); ++t) {
      if (touched_[t] || !is_cap(mesh_, t)) continue;
      if (mend(t, dropped)) mended.push_back(t);
    }
  }

 private:
  bool mend(int cap, std::vector<bool>& dropped) {
    const Triangle t = mesh_.triangles[cap];
    const int side = longest_side(mesh_, t);
    const int a = t[side];
    const int b = t[(side + 1) % 3];
    const int c = t[(side + 2) % 3];
    const auto [first, last] = sides_at(sides_, a, b);
    if (last - first == 1) {
      dropped[cap] = touched_[cap] = true;
      return true;
    }
    if (last - first != 2) return false;
    const HalfEdge& across = first->triangle == cap ? first[1] : first[0];
    if (touched_[across.triangle] || first[0].forward == first[1].forward) return false;
    const int d = mesh_.triangles[across.triangle][(across.corner + 2) % 3];
    const auto [there, end] = sides_at(sides_, c, d);
    if (d == c || there != end) return false;
    mesh_.triangles[cap] = {c, a, d};
    mesh_.triangles[across.triangle] = {b, c, d};
    if (source_[across.triangle] < 0) source_[cap] = -1;  // both are halves of what closes a hole
    touched_[cap] = touched_[across.triangle] = true;
    return true;
  }

  TriangleMesh& mesh_;
  std::vector<int>& source_;
  std::vector<HalfEdge> sides_;
  std::vector<bool> touched_;
};

void drop(const std::vector<bool>& dropped, TriangleMesh& mesh, std::vector<int>& source) {
  std::size_t kept = 0;
  for (std::size_t t = 0; t < dropped.size(); ++t) {
    if (dropped[t]) continue;
    mesh.triangles[kept] = mesh.triangles[t];
    source[kept++] = source[t];
  }
  mesh.triangles.resize(kept);
  source.resize(kept);
}

}  // namespace

CapReport mend_caps(TriangleMesh& mesh, std::vector<int>& source) {
  CapReport report;
  for (int round = 0; round < kMostCapRounds; ++round) {
    bool any = false;
    for (int t = 0; t < static_cast<int>(mesh.triangles.size()) && !any; ++t) any = is_cap(mesh, t);
    if (!any) break;
    std::vector<int> mended;
    std::vector<bool> dropped(mesh.triangles.size(), false);
    CapRound(mesh, source).run(mended, dropped);
    for (int t : mended) report.mended.push_back(source[t]);
    drop(dropped, mesh, source);
    if (mended.empty()) break;
  }
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t)
    if (is_cap(mesh, t)) report.left.push_back(source[t]);
  std::sort(report.mended.begin(), report.mended.end());
  report.mended.erase(std::unique(report.mended.begin(), report.mended.end()), report.mended.end());
  return report;
}

}  // namespace tactum::inline v0_1
