#include "tactum/repair/surface_crossings.h"

#include <algorithm>
#include <cmath>

namespace tactum::inline v0_1 {
namespace {

Aabb box_of(const TriangleMesh& mesh, int triangle) {
  Aabb box;
  for (int corner : mesh.triangles[triangle]) box.extend(mesh.vertices[corner]);
  return box;
}

/// Whether the side from a to b passes the point's height, half-open: +1 upward, -1 downward, else 0.
int passes_height(const Vec3& a, const Vec3& b, double z) {
  if (a.z() <= z && b.z() > z) return 1;
  if (b.z() <= z && a.z() > z) return -1;
  return 0;
}

/// Whether the side lies beyond the point in y at the point's height. The ends are taken lower first, so both
/// triangles at the side get the same answer.
bool beyond_in_y(const Vec3& a, const Vec3& b, const Vec3& p) {
  const Vec3& low = a.z() < b.z() ? a : b;
  const Vec3& high = a.z() < b.z() ? b : a;
  return low.y() + (p.z() - low.z()) / (high.z() - low.z()) * (high.y() - low.y()) > p.y();
}

}  // namespace

SurfaceCrossings::SurfaceCrossings(const TriangleMesh& mesh, const std::vector<int>& surface, int threads)
    : mesh_(mesh), surface_(surface) {
  std::vector<Aabb> boxes;
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
    if (surface[t] < 0) continue;
    taken_.push_back(t);
    boxes.push_back(box_of(mesh, t));
  }
  if (!boxes.empty()) tree_ = Bvh(boxes, 4, threads);
}

int SurfaceCrossings::crossing(int triangle, const Vec3& point) const {
  const Triangle& t = mesh_.triangles[triangle];
  int turns = 0;  // of the triangle's outline about the point, seen against the ray
  for (int i = 0; i < 3; ++i) {
    const Vec3& a = mesh_.vertices[t[i]];
    const Vec3& b = mesh_.vertices[t[(i + 1) % 3]];
    if (const int winding = passes_height(a, b, point.z()); winding != 0 && beyond_in_y(a, b, point))
      turns += winding;
  }
  if (turns == 0) return 0;
  const Vec3& a = mesh_.vertices[t[0]];
  const Vec3 normal = (mesh_.vertices[t[1]] - a).cross(mesh_.vertices[t[2]] - a);
  // The plane's x at the point's y and z lies beyond the point; a plane along the ray is never crossed.
  const double height = normal.dot(point - a);
  if (normal.x() == 0.0 || (height < 0.0) != (normal.x() > 0.0)) return 0;
  return turns;
}

template <class Visitor>
void SurfaceCrossings::for_each_crossing(const Vec3& point, Visitor&& visit) const {
  if (tree_.empty()) return;
  std::vector<int> stack = {0};
  while (!stack.empty()) {
    const int at = stack.back();
    stack.pop_back();
    const Bvh::Node& node = tree_.nodes()[at];
    const Vec3 off = point - node.center;
    if (std::abs(off.y()) > node.half.y() || std::abs(off.z()) > node.half.z() || off.x() > node.half.x())
      continue;
    if (!node.leaf()) {
      stack.push_back(node.second);
      stack.push_back(at + 1);
      continue;
    }
    for (int i = node.second; i < node.second + node.count; ++i) {
      const int triangle = taken_[tree_.order()[i]];
      if (const int winding = crossing(triangle, point); winding != 0) visit(triangle, winding);
    }
  }
}

int SurfaceCrossings::crossed(const Vec3& middle, int triangle) const {
  int count = 0;
  for_each_crossing(middle, [&](int other, int) {
    count += other != triangle && surface_[other] == surface_[triangle] ? 1 : 0;
  });
  return count;
}

std::vector<std::pair<int, int>> SurfaceCrossings::windings(const Vec3& point) const {
  std::vector<std::pair<int, int>> hits;  // (surface, +-1)
  for_each_crossing(point,
                    [&](int triangle, int winding) { hits.emplace_back(surface_[triangle], winding); });
  std::sort(hits.begin(), hits.end());
  std::vector<std::pair<int, int>> sums;
  for (const auto& [surface, winding] : hits) {
    if (sums.empty() || sums.back().first != surface) sums.emplace_back(surface, 0);
    sums.back().second += winding;
  }
  std::erase_if(sums, [](const auto& sum) { return sum.second == 0; });
  return sums;
}

}  // namespace tactum::inline v0_1
