#include "tactum/repair/inner_walls.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "tactum/base/tolerances.h"
#include "tactum/geometry/mesh_edges.h"

namespace tactum::inline v0_1 {
namespace {

bool is_odd_junction(const HalfEdge* first, const HalfEdge* last) {
  return last - first > 2 && (last - first) % 2 != 0;
}

/// The regions of space that the triangles bound. Side 2 t is in front of triangle t, where its normal
/// points, side 2 t + 1 behind it; sides of one set lie in one region.
class Regions {
 public:
  Regions(const TriangleMesh& mesh, const std::vector<HalfEdge>& sides)
      : mesh_(mesh),
        regions_(static_cast<int>(2 * mesh.triangles.size())),
        sets_(static_cast<int>(mesh.triangles.size())) {
    for_each_edge(sides, [&](const HalfEdge* first, const HalfEdge* last) {
      for (const HalfEdge* side = first; side != last; ++side) sets_.join(first->triangle, side->triangle);
      join_around(first, last);
    });
    measure();
  }

  int set_of(int triangle) { return sets_.find(triangle); }

  /// Whether what lies on both sides is no outside of the set.
  bool is_wall(int triangle) { return is_room(2 * triangle) && is_room(2 * triangle + 1); }
  bool is_outside_both(int triangle) {
    return regions_.find(2 * triangle) == regions_.find(2 * triangle + 1) && !is_room(2 * triangle);
  }

 private:
  /// Joins what lies between neighbours around the edge. With e from `low` to `high`, the front of a triangle
  /// that runs along e looks to larger angles about e, and so does the back of one that runs against it.
  void join_around(const HalfEdge* first, const HalfEdge* last) {
    around_.clear();
    const Vec3& origin = mesh_.vertices[first->low];
    const Vec3 e = (mesh_.vertices[first->high] - origin).normalized();
    Vec3 across = Vec3::Zero();
    for (const HalfEdge* side = first; side != last; ++side) {
      const Vec3 to_apex = mesh_.vertices[mesh_.triangles[side->triangle][(side->corner + 2) % 3]] - origin;
      if (side == first) across = (to_apex - e * e.dot(to_apex)).normalized();
      // The order of one or two needs no angle.
      const double angle =
          last - first > 2 ? std::atan2(e.cross(across).dot(to_apex), across.dot(to_apex)) : 0.0;
      around_.emplace_back(angle, side);
    }
    std::stable_sort(around_.begin(), around_.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    for (std::size_t i = 0; i < around_.size(); ++i) {
      const HalfEdge& one = *around_[i].second;
      const HalfEdge& next = *around_[(i + 1) % around_.size()].second;
      regions_.join(2 * one.triangle + (one.forward ? 0 : 1), 2 * next.triangle + (next.forward ? 1 : 0));
    }
  }

  /// The volume of each region, from tetrahedra to a corner of its set: negative for the outside.
  void measure() {
    volume_.assign(2 * mesh_.triangles.size(), 0.0);
    std::vector<Aabb> box(mesh_.triangles.size());
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t)
      for (int corner : mesh_.triangles[t]) box[set_of(static_cast<int>(t))].extend(mesh_.vertices[corner]);
    least_.assign(mesh_.triangles.size(), 0.0);
    for (std::size_t s = 0; s < box.size(); ++s)
      least_[s] = tolerances::kNoVolume * std::pow(box[s].diagonal(), 3);
    for (int t = 0; t < static_cast<int>(mesh_.triangles.size()); ++t) {
      const Triangle& triangle = mesh_.triangles[t];
      const Vec3 origin = box[set_of(t)].center();
      const Vec3 a = mesh_.vertices[triangle[0]] - origin;
      const Vec3 b = mesh_.vertices[triangle[1]] - origin;
      const Vec3 c = mesh_.vertices[triangle[2]] - origin;
      const double volume = a.dot(b.cross(c)) / 6.0;
      volume_[regions_.find(2 * t)] -= volume;
      volume_[regions_.find(2 * t + 1)] += volume;
    }
  }

  bool is_room(int side) { return volume_[regions_.find(side)] > least_[set_of(side / 2)]; }

  const TriangleMesh& mesh_;
  DisjointSets regions_, sets_;
  std::vector<double> volume_;                              ///< of each region, at its number [m^3]
  std::vector<double> least_;                               ///< of a room, at the number of its set [m^3]
  std::vector<std::pair<double, const HalfEdge*>> around_;  ///< angle about the edge [rad], side
};

}  // namespace

std::vector<int> find_inner_walls(const TriangleMesh& mesh) {
  const std::vector<HalfEdge> sides = sorted_half_edges(mesh);
  bool any = false;
  for_each_edge(
      sides, [&](const HalfEdge* first, const HalfEdge* last) { any = any || is_odd_junction(first, last); });
  if (!any) return {};
  Regions regions(mesh, sides);
  enum class Kind : char { kBoundary, kWall, kOutside };
  std::vector<Kind> kind(mesh.triangles.size(), Kind::kBoundary);
  for (int t = 0; t < static_cast<int>(kind.size()); ++t) {
    if (regions.is_wall(t)) {
      kind[t] = Kind::kWall;
    } else if (regions.is_outside_both(t)) {
      kind[t] = Kind::kOutside;
    }
  }
  std::vector<bool> taken(mesh.triangles.size(), false);  // at the number of a set
  std::vector<bool> open(mesh.triangles.size(), false);
  for_each_edge(sides, [&](const HalfEdge* first, const HalfEdge* last) {
    const int set = regions.set_of(first->triangle);
    if (is_odd_junction(first, last)) taken[set] = true;
    int boundary = 0;
    for (const HalfEdge* side = first; side != last; ++side)
      if (kind[side->triangle] == Kind::kBoundary) ++boundary;
    if (boundary % 2 != 0) open[set] = true;
  });
  std::vector<int> walls;
  for (int t = 0; t < static_cast<int>(kind.size()); ++t) {
    const int set = regions.set_of(t);
    if (kind[t] == Kind::kWall && taken[set] && !open[set]) walls.push_back(t);
  }
  return walls;
}

}  // namespace tactum::inline v0_1
