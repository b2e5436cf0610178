#include "tactum/geometry/coplanar_groups.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "tactum/base/tolerances.h"
#include "tactum/geometry/mesh_edges.h"

namespace tactum::inline v0_1 {
namespace {

struct Plane {
  Vec3 normal = Vec3::Zero();  ///< unit; zero when the triangle has no area
  Vec3 point = Vec3::Zero();   ///< [m]
  double area = 0.0;           ///< [m^2]
  double height = 0.0;         ///< over the longest edge [m]
};

Plane plane_of(const TriangleMesh& mesh, const Triangle& t) {
  const Vec3& a = mesh.vertices[t[0]];
  const Vec3& b = mesh.vertices[t[1]];
  const Vec3& c = mesh.vertices[t[2]];
  const Vec3 normal = (b - a).cross(c - a);
  const double longest =
      std::sqrt(std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()}));
  const double length = normal.norm();
  if (!(length > 0.0)) return {};
  return {normal / length, a, 0.5 * length, length / longest};
}

/// Neighbours across edges of exactly two triangles; -1 elsewhere.
std::vector<std::array<int, 3>> neighbours(const TriangleMesh& mesh) {
  std::vector<std::array<int, 3>> across(mesh.triangles.size(), {-1, -1, -1});
  for_each_edge(sorted_half_edges(mesh), [&](const HalfEdge* first, const HalfEdge* last) {
    if (last - first != 2) return;
    across[first[0].triangle][first[0].corner] = first[1].triangle;
    across[first[1].triangle][first[1].corner] = first[0].triangle;
  });
  return across;
}

}  // namespace

std::vector<int> coplanar_groups(const TriangleMesh& welded) {
  const std::size_t count = welded.triangles.size();
  const double size = bounds(welded.vertices).diagonal();
  std::vector<Plane> planes;
  planes.reserve(count);
  for (const Triangle& t : welded.triangles) planes.push_back(plane_of(welded, t));
  const auto belongs = [&](int triangle, const Plane& seed) {
    const Plane& own = planes[triangle];
    const double sine = std::max(tolerances::kCoplanarMeshSine, tolerances::kStoredNoise * size / own.height);
    if (own.normal.dot(seed.normal) <= 0.0 || own.normal.cross(seed.normal).norm() > sine) return false;
    for (int corner : welded.triangles[triangle]) {
      const double height = seed.normal.dot(welded.vertices[corner] - seed.point);
      if (std::abs(height) > tolerances::kCoplanarMeshOffset * size) return false;
    }
    return true;
  };

  std::vector<int> seeds(count);
  std::iota(seeds.begin(), seeds.end(), 0);
  std::stable_sort(seeds.begin(), seeds.end(), [&](int a, int b) { return planes[a].area > planes[b].area; });
  const std::vector<std::array<int, 3>> across = neighbours(welded);
  std::vector<int> group(count, -1);
  std::vector<int> open;
  int groups = 0;
  for (int seed : seeds) {
    if (group[seed] >= 0) continue;
    group[seed] = groups;
    open.assign(1, seed);
    while (!open.empty()) {
      const int at = open.back();
      open.pop_back();
      for (int next : across[at]) {
        if (next < 0 || group[next] >= 0 || !belongs(next, planes[seed])) continue;
        group[next] = groups;
        open.push_back(next);
      }
    }
    ++groups;
  }
  return group;
}

}  // namespace tactum::inline v0_1
