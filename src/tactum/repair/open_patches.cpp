#include "tactum/repair/open_patches.h"

#include <algorithm>
#include <utility>

#include "tactum/base/parallel.h"
#include "tactum/math/screw.h"
#include "tactum/repair/surface_crossings.h"

namespace tactum::inline v0_1 {
namespace {

constexpr std::size_t kTrianglesAtOnce = 1024;

class OpenPatches {
 public:
  OpenPatches(const TriangleMesh& mesh, const std::vector<HalfEdge>& sides, std::vector<bool>& turned,
              OrientedMesh& out, int threads)
      : mesh_(mesh),
        sides_(sides),
        turned_(turned),
        out_(out),
        threads_(threads),
        joined_(static_cast<int>(out.components.size())) {}

  void join() {
    find_sheets();
    for_each_edge(sides_, [&](const HalfEdge* first, const HalfEdge* last) {
      if (last - first == 2) return;
      const HalfEdge* open = nullptr;
      for (const HalfEdge* side = first; side != last; ++side) {
        if (out_.components[patch(*side)].closed || sheet_[patch(*side)]) continue;
        if (open != nullptr) joined_.join(patch(*open), patch(*side));
        open = side;
      }
    });
    find_closed();
    if (std::find(closed_.begin(), closed_.end(), true) == closed_.end()) return;
    turn_as_in_the_file();
    turn_by_parity(out_of_balance());
    const std::vector<bool> left = out_of_balance();  // walls that lie in each other have no parity
    for (std::size_t set = 0; set < left.size(); ++set)
      if (left[set]) closed_[set] = false;
    renumber();
  }

 private:
  int patch(const HalfEdge& side) const { return out_.component[side.triangle]; }
  /// Of the patch, or -1 when it is no part of a set that closes.
  int set_of(int patch) { return closed_[joined_.find(patch)] ? joined_.find(patch) : -1; }

  /// Patches with a rim that no other triangle meets bound nothing; nor do those that are left with such a
  /// rim when these are gone.
  void find_sheets() {
    sheet_.assign(out_.components.size(), false);
    std::vector<std::vector<int>> patches;   // at each edge of one triangle, or of more than two
    std::vector<std::pair<int, int>> edges;  // patch, edge
    for_each_edge(sides_, [&](const HalfEdge* first, const HalfEdge* last) {
      if (last - first == 2) return;
      std::vector<int>& at_edge = patches.emplace_back();
      for (const HalfEdge* side = first; side != last; ++side) {
        at_edge.push_back(patch(*side));
        edges.emplace_back(patch(*side), static_cast<int>(patches.size()) - 1);
      }
    });
    std::sort(edges.begin(), edges.end());
    std::vector<int> waiting;  // edges at which one triangle is left
    const auto look_at = [&](int edge) {
      const std::vector<int>& at_edge = patches[edge];
      if (std::count_if(at_edge.begin(), at_edge.end(), [&](int p) { return !sheet_[p]; }) == 1)
        waiting.push_back(edge);
    };
    for (int edge = 0; edge < static_cast<int>(patches.size()); ++edge) look_at(edge);
    while (!waiting.empty()) {
      const std::vector<int>& at_edge = patches[waiting.back()];
      waiting.pop_back();
      const auto left = std::find_if(at_edge.begin(), at_edge.end(), [&](int p) { return !sheet_[p]; });
      if (left == at_edge.end()) continue;  // it has gone over another edge
      const int sheet = *left;
      sheet_[sheet] = true;
      for (auto it = std::lower_bound(edges.begin(), edges.end(), std::pair(sheet, 0));
           it != edges.end() && it->first == sheet; ++it)
        look_at(it->second);
    }
  }

  void find_closed() {
    closed_.assign(out_.components.size(), true);
    for (std::size_t c = 0; c < out_.components.size(); ++c)
      if (out_.components[c].closed || sheet_[c] || out_.components[c].twisted_edges > 0)
        closed_[joined_.find(static_cast<int>(c))] = false;
    std::vector<int> at_edge;
    for_each_edge(sides_, [&](const HalfEdge* first, const HalfEdge* last) {
      at_edge.clear();
      for (const HalfEdge* side = first; side != last; ++side) at_edge.push_back(joined_.find(patch(*side)));
      std::sort(at_edge.begin(), at_edge.end());
      for (auto it = at_edge.begin(); it != at_edge.end();) {
        const auto end = std::upper_bound(it, at_edge.end(), *it);
        if ((end - it) % 2 != 0) closed_[*it] = false;
        it = end;
      }
    });
  }

  void turn(const std::vector<bool>& patches) {
    for (std::size_t t = 0; t < turned_.size(); ++t)
      if (patches[out_.component[t]]) turned_[t] = !turned_[t];
  }

  /// Each patch as most of its area faced.
  void turn_as_in_the_file() {
    std::vector<double> turned_less_kept(out_.components.size(), 0.0);
    for (std::size_t t = 0; t < turned_.size(); ++t)
      turned_less_kept[out_.component[t]] += (turned_[t] ? 1.0 : -1.0) * normal_of(t).norm();
    std::vector<bool> against(out_.components.size(), false);
    for (std::size_t c = 0; c < against.size(); ++c)
      against[c] = set_of(static_cast<int>(c)) >= 0 && turned_less_kept[c] > 0.0;
    turn(against);
  }

  Vec3 normal_of(std::size_t t) const {
    const Triangle& triangle = mesh_.triangles[t];
    const Vec3& a = mesh_.vertices[triangle[0]];
    return (mesh_.vertices[triangle[1]] - a).cross(mesh_.vertices[triangle[2]] - a);
  }

  /// The sets that run along some edge more often one way than the other.
  std::vector<bool> out_of_balance() {
    std::vector<bool> out(out_.components.size(), false);
    std::vector<std::pair<int, int>> runs;  // set, +1 or -1
    for_each_edge(sides_, [&](const HalfEdge* first, const HalfEdge* last) {
      runs.clear();
      for (const HalfEdge* side = first; side != last; ++side)
        if (const int set = set_of(patch(*side)); set >= 0)
          runs.emplace_back(set, side->forward != turned_[side->triangle] ? 1 : -1);
      std::sort(runs.begin(), runs.end());
      for (auto it = runs.begin(); it != runs.end();) {
        const int set = it->first;
        int sum = 0;
        for (; it != runs.end() && it->first == set; ++it) sum += it->second;
        if (sum != 0) out[set] = true;
      }
    });
    return out;
  }

  /// Each patch of the sets so that what an odd number of triangles encloses lies behind it. The rays run in
  /// a direction that no wall of a made part has.
  void turn_by_parity(const std::vector<bool>& sets) {
    if (std::find(sets.begin(), sets.end(), true) == sets.end()) return;
    const Mat3 R = exp_rotation(Vec3(0.35, 0.81, 1.27));
    TriangleMesh rotated = mesh_;
    for (Vec3& vertex : rotated.vertices) vertex = R * vertex;
    std::vector<int> taken(mesh_.triangles.size(), -1);  // the set of each triangle
    for (std::size_t t = 0; t < taken.size(); ++t)
      if (const int set = set_of(out_.component[t]); set >= 0 && sets[set]) taken[t] = set;
    const SurfaceCrossings crossings(rotated, taken, threads_);
    std::vector<double> outward(taken.size(), 0.0);  // along the ray, twice the area
    for_ranges(threads_, taken.size(), kTrianglesAtOnce, [&](std::size_t first, std::size_t last) {
      for (std::size_t t = first; t < last; ++t) {
        if (taken[t] < 0) continue;
        Vec3 middle = Vec3::Zero();
        for (int corner : rotated.triangles[t]) middle += rotated.vertices[corner] / 3.0;
        const double along = (turned_[t] ? -1.0 : 1.0) * (R * normal_of(t)).x();
        const bool solid_beyond = crossings.crossed(middle, static_cast<int>(t)) % 2 != 0;
        outward[t] = solid_beyond ? -along : along;
      }
    });
    std::vector<double> of_patch(out_.components.size(), 0.0);
    for (std::size_t t = 0; t < taken.size(); ++t) of_patch[out_.component[t]] += outward[t];
    std::vector<bool> wrong(of_patch.size(), false);
    for (std::size_t c = 0; c < wrong.size(); ++c) wrong[c] = of_patch[c] < 0.0;
    turn(wrong);
  }

  void renumber() {
    std::vector<int> number(out_.components.size(), -1);
    std::vector<MeshComponent> components;
    for (int c = 0; c < static_cast<int>(number.size()); ++c) {
      const int first = set_of(c) >= 0 ? set_of(c) : c;  // the lowest of the set
      if (number[first] < 0) {
        number[first] = static_cast<int>(components.size());
        components.push_back(out_.components[first]);
        components.back().closed = out_.components[first].closed || set_of(c) >= 0;
      }
      number[c] = number[first];
    }
    out_.components = std::move(components);
    for (int& component : out_.component) component = number[component];
  }

  const TriangleMesh& mesh_;
  const std::vector<HalfEdge>& sides_;
  std::vector<bool>& turned_;
  OrientedMesh& out_;
  int threads_;
  DisjointSets joined_;
  std::vector<bool> sheet_;   ///< by patch: no part of a set that closes
  std::vector<bool> closed_;  ///< by set: it closes
};

}  // namespace

void join_open_patches(const TriangleMesh& mesh, const std::vector<HalfEdge>& sides,
                       std::vector<bool>& turned, OrientedMesh& out, int threads) {
  OpenPatches(mesh, sides, turned, out, threads).join();
}

}  // namespace tactum::inline v0_1
