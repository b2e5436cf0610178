#include "tactum/repair/repeated_triangles.h"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "tactum/geometry/mesh_edges.h"
#include "tactum/repair/mesh_orientation.h"
#include "tactum/repair/surface_crossings.h"

namespace tactum::inline v0_1 {
namespace {

/// The triangles of three corners: their numbers in the mesh given.
struct Stack {
  std::vector<int> triangles;

  bool even() const { return triangles.size() % 2 == 0; }
};

/// Sorted by their corners.
std::vector<Stack> stacks_of(const TriangleMesh& mesh) {
  std::vector<std::pair<Triangle, int>> sorted;
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
    sorted.emplace_back(mesh.triangles[t], t);
    std::sort(sorted.back().first.begin(), sorted.back().first.end());
  }
  std::sort(sorted.begin(), sorted.end());
  std::vector<Stack> stacks;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    if (i == 0 || sorted[i].first != sorted[i - 1].first) stacks.emplace_back();
    stacks.back().triangles.push_back(sorted[i].second);
  }
  return stacks;
}

/// Stacks of an even number that meet at edges where no other triangle is.
struct Patch {
  int rims_that_need_it = 0;  ///< edges of its rim with an odd number of other triangles
  int rims_closed = 0;        ///< edges of its rim that close without it
  bool ends_free = false;     ///< it has an edge that nothing else reaches
  int largest = -1;           ///< its stack of the largest area
};

/// The first triangle of each stack that `wanted` takes.
template <class Wanted>
TriangleMesh one_of_each(const TriangleMesh& mesh, const std::vector<Stack>& stacks, Wanted&& wanted) {
  TriangleMesh out;
  out.vertices = mesh.vertices;
  for (std::size_t s = 0; s < stacks.size(); ++s)
    if (wanted(static_cast<int>(s))) out.triangles.push_back(mesh.triangles[stacks[s].triangles.front()]);
  return out;
}

double twice_area(const TriangleMesh& mesh, const Triangle& t) {
  const Vec3& a = mesh.vertices[t[0]];
  return (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a).norm();
}

class Sorter {
 public:
  Sorter(const TriangleMesh& mesh, int threads)
      : mesh_(mesh),
        threads_(threads),
        stacks_(stacks_of(mesh)),
        patch_of_(static_cast<int>(stacks_.size())) {}

  RepeatedTriangles run() {
    const bool any_even =
        std::any_of(stacks_.begin(), stacks_.end(), [](const Stack& s) { return s.even(); });
    if (any_even) find_patches();
    std::map<int, bool> is_wall;
    for (const int root : undecided()) is_wall[root] = in_solid(patches_[root].largest);
    RepeatedTriangles out;
    for (int s = 0; s < static_cast<int>(stacks_.size()); ++s) sort(s, is_wall, out);
    for (std::vector<int>* list : {&out.copies, &out.walls, &out.sheets})
      std::sort(list->begin(), list->end());
    return out;
  }

 private:
  void find_patches() {
    const TriangleMesh unique = one_of_each(mesh_, stacks_, [](int) { return true; });
    const std::vector<HalfEdge> sides = sorted_half_edges(unique);
    const auto others_at = [&](const HalfEdge* first, const HalfEdge* last) {
      return std::count_if(first, last, [&](const HalfEdge& side) { return !stacks_[side.triangle].even(); });
    };
    for_each_edge(sides, [&](const HalfEdge* first, const HalfEdge* last) {
      if (others_at(first, last) > 0) return;
      for (const HalfEdge* side = first; side != last; ++side)
        patch_of_.join(first->triangle, side->triangle);
    });
    patches_.resize(stacks_.size());
    for_each_edge(sides, [&](const HalfEdge* first, const HalfEdge* last) {
      const auto others = others_at(first, last);
      for (const HalfEdge* side = first; side != last; ++side) {
        if (!stacks_[side->triangle].even()) continue;
        Patch& patch = patches_[patch_of_.find(side->triangle)];
        if (others > 0) ++(others % 2 != 0 ? patch.rims_that_need_it : patch.rims_closed);
        if (others == 0 && last - first == 1) patch.ends_free = true;
      }
    });
    for (int s = 0; s < static_cast<int>(stacks_.size()); ++s) {
      if (!stacks_[s].even()) continue;
      int& largest = patches_[patch_of_.find(s)].largest;
      if (largest < 0 || area(s) > area(largest)) largest = s;
    }
  }

  double area(int stack) const {
    return twice_area(mesh_, mesh_.triangles[stacks_[stack].triangles.front()]);
  }

  bool is_copy(const Patch& patch) const {
    const int rims = patch.rims_that_need_it + patch.rims_closed;
    return rims > 0 ? patch.rims_that_need_it > patch.rims_closed : !patch.ends_free;
  }

  /// Patches, by their roots, that are a wall or a sheet.
  std::vector<int> undecided() const {
    std::vector<int> roots;
    for (int s = 0; s < static_cast<int>(patches_.size()); ++s)
      if (patches_[s].largest >= 0 && !is_copy(patches_[s])) roots.push_back(s);
    return roots;
  }

  /// Whether the middle of the triangle lies inside what closes without walls and sheets.
  bool in_solid(int stack) {
    if (!crossings_) {
      rest_ = one_of_each(mesh_, stacks_,
                          [&](int s) { return !stacks_[s].even() || is_copy(patches_[patch_of_.find(s)]); });
      const OrientedMesh oriented = orient_components(rest_, threads_);
      for (const int component : oriented.component)
        surface_.push_back(oriented.components[component].closed ? 0 : -1);
      crossings_.emplace(rest_, surface_, threads_);
    }
    Vec3 middle = Vec3::Zero();
    for (int corner : mesh_.triangles[stacks_[stack].triangles.front()])
      middle += mesh_.vertices[corner] / 3.0;
    return !crossings_->windings(middle).empty();
  }

  void sort(int stack, const std::map<int, bool>& is_wall, RepeatedTriangles& out) {
    const std::vector<int>& all = stacks_[stack].triangles;
    const bool single = !stacks_[stack].even();
    const auto found = single ? is_wall.end() : is_wall.find(patch_of_.find(stack));
    if (found != is_wall.end() && found->second) {
      out.walls.insert(out.walls.end(), all.begin(), all.end());
      return;
    }
    std::vector<int>& list = found != is_wall.end() ? out.sheets : out.copies;
    list.insert(list.end(), all.begin() + 1, all.end());
  }

  const TriangleMesh& mesh_;
  int threads_;
  std::vector<Stack> stacks_;
  DisjointSets patch_of_;
  std::vector<Patch> patches_;                 ///< at their roots
  TriangleMesh rest_;                          ///< what is neither wall nor sheet, oriented
  std::vector<int> surface_;                   ///< of rest_, as SurfaceCrossings takes it
  std::optional<SurfaceCrossings> crossings_;  ///< of rest_, made when it is asked for
};

}  // namespace

RepeatedTriangles find_repeated_triangles(const TriangleMesh& mesh, int threads) {
  return Sorter(mesh, threads).run();
}

}  // namespace tactum::inline v0_1
