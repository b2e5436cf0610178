#include "tactum/mesh/hole_filling.h"

#include <algorithm>
#include <limits>
#include <set>
#include <utility>

#include "tactum/geometry/mesh_edges.h"

namespace tactum::inline v0_1 {
namespace {

constexpr double kForbidden = std::numeric_limits<double>::infinity();

struct OpenEdge {
  int from = 0, to = 0;  ///< as a triangle in the hole would run
  int triangle = 0;      ///< at the edge
};

std::vector<OpenEdge> open_edges(const TriangleMesh& mesh) {
  std::vector<OpenEdge> open;
  for_each_edge(sorted_half_edges(mesh), [&](const HalfEdge* first, const HalfEdge* last) {
    if (last - first != 1) return;
    const bool forward = first->forward;
    open.push_back({forward ? first->high : first->low, forward ? first->low : first->high, first->triangle});
  });
  return open;
}

/// The triangulation of least area of one rim.
class RimFill {
 public:
  RimFill(const TriangleMesh& mesh, const std::vector<int>& rim, const std::set<std::pair<int, int>>& taken)
      : mesh_(mesh), rim_(rim), n_(static_cast<int>(rim.size())), cost_(n_ * n_, 0.0), apex_(n_ * n_, -1) {
    for (int span = 2; span < n_; ++span) {
      for (int i = 0; i + span < n_; ++i) solve(i, i + span, taken);
    }
  }
  bool possible() const { return cost_[n_ - 1] < kForbidden; }
  void append(std::vector<Triangle>& triangles) const { append(0, n_ - 1, triangles); }

 private:
  /// The best apex over the chord from corner i to corner k.
  void solve(int i, int k, const std::set<std::pair<int, int>>& taken) {
    double best = kForbidden;
    const bool chord = k - i < n_ - 1;
    const std::pair<int, int> ends = std::minmax(rim_[i], rim_[k]);
    if (!chord || taken.find(ends) == taken.end()) {
      for (int m = i + 1; m < k; ++m) {
        const double cost = cost_[i * n_ + m] + cost_[m * n_ + k] + area(i, m, k);
        if (cost < best) {
          best = cost;
          apex_[i * n_ + k] = m;
        }
      }
    }
    cost_[i * n_ + k] = best;
  }
  double area(int i, int m, int k) const {
    const Vec3& a = mesh_.vertices[rim_[i]];
    return 0.5 * (mesh_.vertices[rim_[m]] - a).cross(mesh_.vertices[rim_[k]] - a).norm();
  }
  void append(int i, int k, std::vector<Triangle>& triangles) const {
    if (k - i < 2) return;
    const int m = apex_[i * n_ + k];
    append(i, m, triangles);
    append(m, k, triangles);
    triangles.push_back({rim_[i], rim_[m], rim_[k]});
  }

  const TriangleMesh& mesh_;
  const std::vector<int>& rim_;
  int n_;
  std::vector<double> cost_;
  std::vector<int> apex_;
};

}  // namespace

std::vector<Rim> rims_of(const TriangleMesh& mesh) {
  const std::vector<OpenEdge> open = open_edges(mesh);
  std::vector<std::vector<int>> leaving(mesh.vertices.size());  // numbers of open edges from each vertex
  for (std::size_t i = 0; i < open.size(); ++i) leaving[open[i].from].push_back(static_cast<int>(i));
  std::vector<bool> walked(open.size(), false);
  std::vector<Rim> rims;
  for (std::size_t seed = 0; seed < open.size(); ++seed) {
    if (walked[seed]) continue;
    Rim rim;
    rim.triangle = open[seed].triangle;
    int at = static_cast<int>(seed);
    while (at >= 0 && !walked[at]) {
      walked[at] = true;
      rim.vertices.push_back(open[at].from);
      const std::vector<int>& next = leaving[open[at].to];
      if (next.size() != 1) rim.simple = false;
      const auto fresh = std::find_if(next.begin(), next.end(), [&](int edge) { return !walked[edge]; });
      if (fresh == next.end()) break;
      at = *fresh;
    }
    if (open[at].to != rim.vertices.front()) rim.simple = false;
    rims.push_back(std::move(rim));
  }
  return rims;
}

std::vector<Rim> close_holes(TriangleMesh& mesh, int most_edges) {
  std::vector<Rim> rims = rims_of(mesh);
  if (most_edges <= 0) return rims;
  std::set<std::pair<int, int>> taken;  // edges that are there, between vertices of rims
  std::vector<bool> on_rim(mesh.vertices.size(), false);
  for (const Rim& rim : rims)
    for (int vertex : rim.vertices) on_rim[vertex] = true;
  const auto take = [&](const Triangle& t) {
    for (int i = 0; i < 3; ++i)
      if (on_rim[t[i]] && on_rim[t[(i + 1) % 3]]) taken.insert(std::minmax(t[i], t[(i + 1) % 3]));
  };
  for (const Triangle& t : mesh.triangles) take(t);
  for (Rim& rim : rims) {
    const int edges = static_cast<int>(rim.vertices.size());
    if (!rim.simple || edges < 3 || edges > std::min(most_edges, kMostRimEdges)) continue;
    const RimFill fill(mesh, rim.vertices, taken);
    if (!fill.possible()) continue;
    const std::size_t before = mesh.triangles.size();
    fill.append(mesh.triangles);
    for (std::size_t t = before; t < mesh.triangles.size(); ++t) take(mesh.triangles[t]);
    rim.closed = true;
  }
  return rims;
}

}  // namespace tactum::inline v0_1
