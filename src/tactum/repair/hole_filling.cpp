#include "tactum/repair/hole_filling.h"

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
  double least_area() const { return cost_[n_ - 1]; }
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

/// Walks along open edges, whichever way their triangles run, and takes off a rim wherever the walk comes
/// back to itself. Of several edges on it takes the one that turns back most sharply: the other bank of a
/// crack.
class RimWalk {
 public:
  explicit RimWalk(const TriangleMesh& mesh)
      : mesh_(mesh),
        open_(open_edges(mesh)),
        at_(mesh.vertices.size()),
        place_(mesh.vertices.size(), -1),
        walked_(open_.size(), false) {
    for (int i = 0; i < static_cast<int>(open_.size()); ++i) {
      at_[open_[i].from].push_back(i);
      at_[open_[i].to].push_back(i);
    }
  }

  std::vector<Rim> run() {
    for (int seed = 0; seed < static_cast<int>(open_.size()); ++seed) {
      if (walked_[seed]) continue;
      int from = open_[seed].from;
      for (int edge = seed; edge >= 0; edge = next_edge(from)) {
        const int to = open_[edge].from == from ? open_[edge].to : open_[edge].from;
        walked_[edge] = true;
        place_[from] = static_cast<int>(walk_.size());
        walk_.push_back({from, edge});
        if (place_[to] >= 0) cut_loop(place_[to]);
        from = to;
      }
      if (walk_.empty()) continue;
      cut_loop(0);
      rims_.back().simple = false;
    }
    return std::move(rims_);
  }

 private:
  struct Step {
    int from = 0, edge = 0;
  };
  static constexpr std::size_t kMostTurns = 64;  ///< where more rims meet, any turn is taken

  /// The edge to go on by from a vertex; -1: there is none.
  int next_edge(int vertex) {
    std::vector<int>& edges = at_[vertex];
    while (!edges.empty() && walked_[edges.back()]) edges.pop_back();
    if (edges.size() > kMostTurns) return edges.back();
    Vec3 came = Vec3::Zero();
    if (!walk_.empty()) came = (mesh_.vertices[vertex] - mesh_.vertices[walk_.back().from]).normalized();
    int best = -1;
    double least = 2.0;
    for (int edge : edges) {
      if (walked_[edge]) continue;
      const int end = open_[edge].from == vertex ? open_[edge].to : open_[edge].from;
      const double along = came.dot((mesh_.vertices[end] - mesh_.vertices[vertex]).normalized());
      if (along >= least) continue;
      least = along;
      best = edge;
    }
    return best;
  }

  /// Takes the steps from number `first` on off the walk, as a rim.
  void cut_loop(int first) {
    Rim& rim = rims_.emplace_back();
    rim.triangle = open_[walk_[first].edge].triangle;
    for (auto step = walk_.begin() + first; step != walk_.end(); ++step) {
      rim.vertices.push_back(step->from);
      place_[step->from] = -1;
    }
    walk_.resize(first);
  }

  const TriangleMesh& mesh_;
  std::vector<OpenEdge> open_;
  std::vector<std::vector<int>> at_;  ///< numbers of open edges, by vertex
  std::vector<int> place_;            ///< in the walk, by vertex; -1: not on it
  std::vector<bool> walked_;          ///< by edge
  std::vector<Step> walk_;
  std::vector<Rim> rims_;
};

/// Whether the rim is the outline of one triangle, whose other side would close it.
bool is_lone_triangle(const Rim& rim, const TriangleMesh& mesh) {
  const Triangle& t = mesh.triangles[rim.triangle];
  return rim.vertices.size() == 3 && std::all_of(rim.vertices.begin(), rim.vertices.end(), [&](int vertex) {
           return std::find(t.begin(), t.end(), vertex) != t.end();
         });
}

/// A square hole, whose area is a sixteenth of its rim's length squared, is no crack however small it is.
constexpr double kSlenderness = 0.02;

/// The area of the rim as seen from where it looks largest: no triangulation has less.
double flat_area(const Rim& rim, const TriangleMesh& mesh) {
  const Vec3& origin = mesh.vertices[rim.vertices.front()];
  Vec3 twice = Vec3::Zero();
  for (std::size_t i = 1; i + 1 < rim.vertices.size(); ++i)
    twice += (mesh.vertices[rim.vertices[i]] - origin).cross(mesh.vertices[rim.vertices[i + 1]] - origin);
  return 0.5 * twice.norm();
}

double length_of(const Rim& rim, const TriangleMesh& mesh) {
  double length = 0.0;
  for (std::size_t i = 0; i < rim.vertices.size(); ++i)
    length +=
        (mesh.vertices[rim.vertices[(i + 1) % rim.vertices.size()]] - mesh.vertices[rim.vertices[i]]).norm();
  return length;
}

}  // namespace

std::vector<Rim> rims_of(const TriangleMesh& mesh) { return RimWalk(mesh).run(); }

std::vector<Rim> close_holes(TriangleMesh& mesh, int most_edges) {
  std::vector<Rim> rims = rims_of(mesh);
  if (rims.empty()) return rims;
  const double narrowest = 0.5 * kCrackWidth * bounds(mesh.vertices).diagonal();
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
    if (!rim.simple || edges < 3 || edges > kMostRimEdges || is_lone_triangle(rim, mesh)) continue;
    const double length = length_of(rim, mesh);
    const double widest_crack = std::min(narrowest * length, kSlenderness * length * length);  // its area
    if (edges > most_edges && flat_area(rim, mesh) >= widest_crack) continue;
    const RimFill fill(mesh, rim.vertices, taken);
    if (!fill.possible()) continue;
    rim.crack = fill.least_area() < widest_crack;
    if (!rim.crack && edges > most_edges) continue;
    const std::size_t before = mesh.triangles.size();
    fill.append(mesh.triangles);
    for (std::size_t t = before; t < mesh.triangles.size(); ++t) take(mesh.triangles[t]);
    rim.closed = true;
  }
  return rims;
}

}  // namespace tactum::inline v0_1
