#include "tactum/geometry/surface_tree.h"

#include <algorithm>

#include "tactum/geometry/coplanar_groups.h"
#include "tactum/geometry/surface_boxes.h"
#include "tactum/geometry/surface_cones.h"

namespace tactum::inline v0_1 {

SurfaceTree::SurfaceTree(const TriangleMesh& welded) : SurfaceTree(welded, coplanar_groups(welded)) {}

SurfaceTree::SurfaceTree(const TriangleMesh& welded, const std::vector<int>& group, int threads)
    : vertices_(welded.vertices), triangles_(welded.triangles), group_(group.begin(), group.end()) {
  const Aabb box = bounds(vertices_);
  scalars_.size = box.diagonal();
  if (empty()) return;
  const Vec3 center = box.center();
  scalars_.center = {center.x(), center.y(), center.z()};
  SurfaceCones cones = surface_cones(welded, group);
  SurfaceBoxes boxes(welded, cones, center, threads);
  beyond_ = std::move(cones.beyond);
  narrow_ = std::move(cones.narrow);
  first_around_ = std::move(cones.first_around);
  around_ = std::move(cones.around);
  nodes_ = std::move(boxes.nodes);
  leaves_ = std::move(boxes.leaves);
  scalars_.root = boxes.root;
}

std::size_t SurfaceTree::memory() const noexcept {
  std::size_t bytes = sizeof(*this);
  for_each_array([&](const auto& array) { bytes += array.capacity() * sizeof(array[0]); });
  return bytes;
}

bool SurfaceTree::sound(std::int32_t first, std::int32_t last) const noexcept {
  // Children stand behind their parents, so no walk cycles.
  for (std::int32_t i = first; i < last; ++i) {
    for (std::int32_t child : nodes_[std::size_t(i)].child) {
      if (child > 0 ? child <= i || child >= last : child < 0 && std::size_t(~child) >= leaves_.size())
        return false;
    }
  }
  return true;
}

bool SurfaceTree::sound() const noexcept {
  if (empty()) return nodes_.empty() && leaves_.empty();
  const int triangles = triangle_count();
  const int vertices = vertex_count();
  const auto is_triangle = [&](std::int32_t t) { return t >= 0 && t < triangles; };
  const auto is_vertex = [&](std::int32_t v) { return v >= 0 && v < vertices; };
  const std::size_t count = triangles_.size();
  if (group_.size() != count || beyond_.size() != count || narrow_.size() != count) return false;
  if (first_around_.size() != vertices_.size() + 1) return false;
  if (first_around_.front() != 0 || std::size_t(first_around_.back()) != around_.size()) return false;
  if (!std::is_sorted(first_around_.begin(), first_around_.end())) return false;
  if (!std::all_of(around_.begin(), around_.end(),
                   [&](std::int32_t w) { return w >= 0 ? is_vertex(w) : is_triangle(~w); }))
    return false;
  for (std::size_t t = 0; t < count; ++t) {
    if (!std::all_of(triangles_[t].begin(), triangles_[t].end(), is_vertex)) return false;
    if (!std::all_of(beyond_[t].begin(), beyond_[t].end(),
                     [&](std::int32_t w) { return w == kWall || is_vertex(w); }))
      return false;
  }
  const auto is_corner = [&](std::int32_t c) { return c == -1 || (c >= 0 && is_triangle(c / 3)); };
  if (!std::all_of(leaves_.begin(), leaves_.end(),
                   [&](const Corners& leaf) { return std::all_of(leaf.begin(), leaf.end(), is_corner); }))
    return false;
  // Nodes of a kind begin with its root and end with the next kind's.
  std::array<std::int32_t, 4> first{0, 0, 0, static_cast<std::int32_t>(nodes_.size())};
  for (std::size_t kind = 3; kind-- > 0;) {
    const std::int32_t root = scalars_.root[kind];
    if (root < -1 || root >= first[kind + 1]) return false;
    first[kind] = root < 0 ? first[kind + 1] : root;
  }
  return first[0] == 0 && sound(first[0], first[1]) && sound(first[1], first[2]) && sound(first[2], first[3]);
}

}  // namespace tactum::inline v0_1
