#include "tactum/geometry/surface_cones.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "tactum/base/tolerances.h"
#include "tactum/geometry/mesh_edges.h"
#include "tactum/geometry/surface_layout.h"

namespace tactum::inline v0_1 {
namespace {

double angle_between(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

/// The largest angle from the unit vector to one of the rays [rad]. Cosines choose the rays whose angles
/// are computed: where thousands of triangles meet in one vertex, this is called for each with as many rays.
double largest_angle(const Vec3& from, const std::vector<Vec3>& rays) {
  constexpr double kRounding = 8.0 * std::numeric_limits<double>::epsilon();  // of a dot product
  double smallest_cosine = 1.0;
  for (const Vec3& ray : rays) smallest_cosine = std::min(smallest_cosine, from.dot(ray));
  double largest = 0.0;
  for (const Vec3& ray : rays) {
    if (from.dot(ray) <= smallest_cosine + kRounding) largest = std::max(largest, angle_between(from, ray));
  }
  return largest;
}

/// The part of the hull of `rays` (in turn around it) where e . u <= 0.
std::vector<Vec3> clipped(const std::vector<Vec3>& rays, const Vec3& e) {
  std::vector<Vec3> left;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Vec3& at = rays[i];
    const Vec3& next = rays[(i + 1) % rays.size()];
    const double here = e.dot(at);
    const double there = e.dot(next);
    if (here <= 0.0) left.push_back(at);
    if ((here < 0.0 && there > 0.0) || (here > 0.0 && there < 0.0)) {
      left.push_back((std::abs(there) * at + std::abs(here) * next).normalized());
    }
  }
  return left;
}

class Finder {
 public:
  Finder(const TriangleMesh& mesh, const std::vector<int>& group) : mesh_(mesh), group_(group) {
    const std::size_t count = mesh.triangles.size();
    cones_.normal.reserve(count);
    for (const Triangle& t : mesh.triangles) {
      const Vec3 across = (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0]));
      const double length = across.norm();
      cones_.normal.push_back(length > 0.0 ? Vec3(across / length) : Vec3::UnitZ());
    }
    cones_.beyond.assign(count, {SurfaceLayout::kWall, SurfaceLayout::kWall, SurfaceLayout::kWall});
    cones_.narrow.assign(count, 0);
    rim_.assign(count, 0);
  }

  SurfaceCones run() {
    for_each_edge(sorted_half_edges(mesh_),
                  [&](const HalfEdge* first, const HalfEdge* last) { take_edge(first, last); });
    take_vertices();
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      cones_.features[SurfaceLayout::kFaces].push_back(
          {static_cast<std::int32_t>(3 * t), cones_.normal[t], 0.0});
    }
    return std::move(cones_);
  }

 private:
  const Vec3& at(int vertex) const { return mesh_.vertices[vertex]; }

  /// `lean`: the largest angle from the triangle's normal to a direction of the cone [rad].
  void own(SurfaceLayout::Kind kind, int triangle, int k, const Vec3& axis, double width, double lean) {
    cones_.features[kind].push_back({3 * triangle + k, axis, width});
    const unsigned bit = unsigned(k) + (kind == SurfaceLayout::kEdges ? 0u : 3u);
    if (lean <= 0.5 * kPi) cones_.narrow[triangle] |= static_cast<std::uint8_t>(1u << bit);
  }

  void take_edge(const HalfEdge* first, const HalfEdge* last) {
    if (last - first != 2 || first[0].forward == first[1].forward) {
      for (const HalfEdge* side = first; side != last; ++side) {
        rim_[side->triangle] |= static_cast<std::uint8_t>(1u << unsigned(side->corner));
        const Triangle& t = mesh_.triangles[side->triangle];
        const Vec3& normal = cones_.normal[side->triangle];
        const Vec3 along = at(t[(side->corner + 1) % 3]) - at(t[side->corner]);
        own(SurfaceLayout::kEdges, side->triangle, side->corner,
            (normal + along.cross(normal).normalized()).normalized(), 0.25 * kPi, 0.5 * kPi);
      }
      return;
    }
    const HalfEdge& side = first[0];
    if (group_[side.triangle] == group_[first[1].triangle]) return;
    const int apex = mesh_.triangles[first[1].triangle][(first[1].corner + 2) % 3];
    const Vec3& normal = cones_.normal[side.triangle];
    const Vec3& other = cones_.normal[first[1].triangle];
    // Folded shut, the apex is in the plane; that is a fin, not a crack, when both agree on it.
    const double below = -normal.dot(at(apex) - at(side.low));
    if (below < 0.0 || (below == 0.0 && normal.dot(other) > 0.0)) return;
    cones_.beyond[side.triangle][side.corner] = apex;
    const double turn = angle_between(normal, other);
    // Folded shut, the normals cancel: then the middle is away from the face.
    const Triangle& t = mesh_.triangles[side.triangle];
    const Vec3 away = (at(t[(side.corner + 1) % 3]) - at(t[side.corner])).cross(normal).normalized();
    const Vec3 middle = std::cos(0.5 * turn) * normal + std::sin(0.5 * turn) * away;
    own(SurfaceLayout::kEdges, side.triangle, side.corner, middle, 0.5 * turn, turn);
  }

  void take_vertices() {
    std::vector<int> first(mesh_.vertices.size() + 1, 0);  // corners 3 t + k by vertex
    for (const Triangle& t : mesh_.triangles) {
      for (int v : t) ++first[v + 1];
    }
    for (std::size_t v = 0; v < mesh_.vertices.size(); ++v) first[v + 1] += first[v];
    std::vector<int> corners(3 * mesh_.triangles.size());
    std::vector<int> next(first.begin(), first.end() - 1);
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k)
        corners[next[mesh_.triangles[t][k]]++] = static_cast<int>(3 * t + k);
    }
    cones_.first_around.assign(mesh_.vertices.size() + 1, 0);
    for (std::size_t v = 0; v < mesh_.vertices.size(); ++v) {
      take_vertex(static_cast<int>(v), {corners.data() + first[v], corners.data() + first[v + 1]});
      cones_.first_around[v + 1] = static_cast<std::int32_t>(cones_.around.size());
    }
    cones_.around.shrink_to_fit();
  }

  void take_vertex(int vertex, std::span<const int> corners) {
    around_.clear();
    bool flat = true;
    Vec3 outward = Vec3::Zero();  // weighted by angles: points outside at any vertex [Baerentzen 2005]
    for (int corner : corners) {
      const int t = corner / 3;
      const int k = corner % 3;
      const Triangle& triangle = mesh_.triangles[t];
      const int after = triangle[(k + 1) % 3];
      const int before = triangle[(k + 2) % 3];
      around_.push_back(after);
      around_.push_back(before);
      const bool rim = ((rim_[t] >> k) & 1) != 0 || ((rim_[t] >> ((k + 2) % 3)) & 1) != 0;
      if (rim) around_.push_back(~t);
      flat = flat && !rim && group_[t] == group_[corners[0] / 3];
      outward += cones_.normal[t] * angle_between(at(after) - at(vertex), at(before) - at(vertex));
    }
    if (flat) return;
    std::sort(around_.begin(), around_.end());
    around_.erase(std::unique(around_.begin(), around_.end()), around_.end());
    edges_.clear();
    for (int w : around_)
      edges_.push_back(w >= 0 ? (at(w) - at(vertex)).normalized() : Vec3(-cones_.normal[~w]));
    const std::vector<Vec3> rays = polar_cone(edges_);
    Vec3 middle = Vec3::Zero();
    for (const Vec3& ray : rays) middle += ray;
    if (rays.empty() || !(middle.norm() > tolerances::kSameNormal) ||
        middle.dot(outward) < -tolerances::kSameNormal)
      return;
    give(corners, rays);
    cones_.around.insert(cones_.around.end(), around_.begin(), around_.end());
  }

  /// Gives the cone to the triangle whose normal is nearest to the cone's farthest ray.
  void give(std::span<const int> corners, const std::vector<Vec3>& rays) {
    int best = -1;
    double best_lean = 0.0;
    for (int corner : corners) {
      const double lean = largest_angle(cones_.normal[corner / 3], rays);
      if (best < 0 || lean < best_lean) {
        best = corner;
        best_lean = lean;
      }
    }
    Vec3 axis = Vec3::Zero();
    for (const Vec3& ray : rays) axis += ray;
    axis.normalize();
    const double width = largest_angle(axis, rays);
    // Beyond a right angle the hull of rays may extend farther than its rays.
    own(SurfaceLayout::kVertices, best / 3, best % 3, axis, width < 0.5 * kPi ? width : kPi, best_lean);
  }

  const TriangleMesh& mesh_;
  const std::vector<int>& group_;
  SurfaceCones cones_;
  std::vector<std::uint8_t> rim_;  // of each triangle: which sides are rims
  std::vector<std::int32_t> around_;
  std::vector<Vec3> edges_;
};

}  // namespace

std::vector<Vec3> polar_cone(const std::vector<Vec3>& edges) {
  // All directions, as four cones; the rest of each may be one more part of the answer.
  const std::array<Vec3, 4> corner = {Vec3(1, 1, 1), Vec3(1, -1, -1), Vec3(-1, 1, -1), Vec3(-1, -1, 1)};
  std::vector<Vec3> all;
  for (std::size_t i = 0; i < 4; ++i) {
    std::vector<Vec3> rays = {corner[(i + 1) % 4].normalized(), corner[(i + 2) % 4].normalized(),
                              corner[(i + 3) % 4].normalized()};
    for (const Vec3& e : edges) {
      rays = clipped(rays, e);
      if (rays.size() < 3) break;
    }
    if (rays.size() < 3) continue;
    Vec3 area = Vec3::Zero();
    for (std::size_t k = 0; k < rays.size(); ++k) area += rays[k].cross(rays[(k + 1) % rays.size()]);
    if (area.norm() > tolerances::kCoplanarMeshSine * tolerances::kCoplanarMeshSine) {
      all.insert(all.end(), rays.begin(), rays.end());
    }
  }
  return all;
}

SurfaceCones surface_cones(const TriangleMesh& mesh, const std::vector<int>& group) {
  return Finder(mesh, group).run();
}

}  // namespace tactum::inline v0_1
