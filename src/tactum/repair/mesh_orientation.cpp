#include "tactum/repair/mesh_orientation.h"

#include <algorithm>
#include <cmath>

#include "tactum/base/parallel.h"
#include "tactum/base/tolerances.h"
#include "tactum/geometry/bvh.h"
#include "tactum/geometry/mesh_edges.h"
#include "tactum/repair/open_patches.h"
#include "tactum/repair/surface_crossings.h"

namespace tactum::inline v0_1 {
namespace {

/// Across each side of each triangle: the neighbour, and whether both run along the side in one direction.
struct Neighbour {
  int triangle = -1;
  bool against = false;
};

void turn(Triangle& triangle) { std::swap(triangle[1], triangle[2]); }

std::vector<Neighbour> neighbours_of(const std::vector<HalfEdge>& sides, std::size_t triangles) {
  std::vector<Neighbour> neighbours(3 * triangles);
  for_each_edge(sides, [&](const HalfEdge* first, const HalfEdge* last) {
    if (last - first != 2) return;
    const bool against = first[0].forward == first[1].forward;
    neighbours[3 * first[0].triangle + first[0].corner] = {first[1].triangle, against};
    neighbours[3 * first[1].triangle + first[1].corner] = {first[0].triangle, against};
  });
  return neighbours;
}

/// Numbers the component of each triangle and marks those that must turn to agree with the component's first.
std::vector<bool> flood(const std::vector<Neighbour>& neighbours, OrientedMesh& out) {
  std::vector<bool> turned(out.component.size(), false);
  std::vector<int> queue;
  for (int seed = 0; seed < static_cast<int>(out.component.size()); ++seed) {
    if (out.component[seed] >= 0) continue;
    const int name = static_cast<int>(out.components.size());
    out.components.emplace_back().first_triangle = seed;
    out.component[seed] = name;
    queue.assign(1, seed);
    while (!queue.empty()) {
      const int at = queue.back();
      queue.pop_back();
      for (int corner = 0; corner < 3; ++corner) {
        const Neighbour& next = neighbours[3 * at + corner];
        if (next.triangle < 0 || out.component[next.triangle] >= 0) continue;
        out.component[next.triangle] = name;
        turned[next.triangle] = turned[at] != next.against;
        queue.push_back(next.triangle);
      }
    }
  }
  return turned;
}

/// Closed: at every edge an even number of the component's triangles. Twisted: two that cannot agree.
void report_edges(const std::vector<HalfEdge>& sides, const std::vector<bool>& turned, OrientedMesh& out) {
  for (MeshComponent& component : out.components) component.closed = true;
  std::vector<int> at_edge;
  for_each_edge(sides, [&](const HalfEdge* first, const HalfEdge* last) {
    at_edge.clear();
    for (const HalfEdge* side = first; side != last; ++side) at_edge.push_back(out.component[side->triangle]);
    std::sort(at_edge.begin(), at_edge.end());
    for (auto it = at_edge.begin(); it != at_edge.end();) {
      const auto end = std::upper_bound(it, at_edge.end(), *it);
      if ((end - it) % 2 != 0) out.components[*it].closed = false;
      it = end;
    }
    if (last - first != 2) return;
    const bool one = first[0].forward != turned[first[0].triangle];
    const bool other = first[1].forward != turned[first[1].triangle];
    if (one == other) ++out.components[out.component[first->triangle]].twisted_edges;
  });
}

/// Volume, area and box of the components, and the area that was turned to agree.
std::vector<double> measure(const TriangleMesh& mesh, const std::vector<bool>& turned, OrientedMesh& out) {
  std::vector<double> turned_area(out.components.size(), 0.0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    MeshComponent& component = out.components[out.component[t]];
    for (int corner : mesh.triangles[t]) component.box.extend(mesh.vertices[corner]);
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    MeshComponent& component = out.components[out.component[t]];
    const Vec3 origin = component.box.center();
    const Vec3 a = mesh.vertices[mesh.triangles[t][0]] - origin;
    const Vec3 b = mesh.vertices[mesh.triangles[t][1]] - origin;
    const Vec3 c = mesh.vertices[mesh.triangles[t][2]] - origin;
    const double area = 0.5 * (b - a).cross(c - a).norm();
    ++component.triangles;
    component.area += area;
    component.volume += a.dot(b.cross(c)) / 6.0;
    if (turned[t]) turned_area[out.component[t]] += area;
  }
  for (MeshComponent& component : out.components)
    if (!component.closed) component.volume = 0.0;
  return turned_area;
}

bool encloses(const MeshComponent& component) {
  return component.closed && component.twisted_edges == 0 && !component.empty_inside();
}

/// Whether the boxes have more than their sides in common.
bool cut(const Aabb& a, const Aabb& b) {
  return (a.min.array() < b.max.array()).all() && (b.min.array() < a.max.array()).all();
}

/// The components that enclose something and whose boxes cut the box of another such: only these can lie in
/// one another.
std::vector<bool> neighbours_by_box(const std::vector<MeshComponent>& components, int threads) {
  std::vector<int> enclosing;
  std::vector<Aabb> boxes;
  for (int c = 0; c < static_cast<int>(components.size()); ++c) {
    if (!encloses(components[c])) continue;
    enclosing.push_back(c);
    boxes.push_back(components[c].box);
  }
  const Bvh tree(boxes, 1, threads);
  const auto cuts_one = [&](int own) {
    std::vector<int> stack = {0};
    while (!stack.empty()) {
      const int at = stack.back();
      stack.pop_back();
      const Bvh::Node& node = tree.nodes()[at];
      if (!cut(boxes[own], {node.center - node.half, node.center + node.half})) continue;
      if (!node.leaf()) {
        stack.push_back(node.second);
        stack.push_back(at + 1);
      } else if (const int other = tree.order()[node.second]; other != own && cut(boxes[own], boxes[other])) {
        return true;
      }
    }
    return false;
  };
  std::vector<bool> out(components.size(), false);
  for (int i = 0; i < static_cast<int>(enclosing.size()); ++i) out[enclosing[i]] = cuts_one(i);
  return out;
}

/// How many of the others a component lies in, from the numbers of those that `count` of its points lie in,
/// all points together.
void take_depth(std::vector<int>& around, int count, MeshComponent& component) {
  std::sort(around.begin(), around.end());
  for (auto it = around.begin(); it != around.end();) {
    const auto end = std::upper_bound(it, around.end(), *it);
    if (end - it == count) {
      ++component.depth;
    } else {
      component.cuts_other = true;
    }
    it = end;
  }
}

/// How many closed components each closed one lies in, tested at a few of its triangles' centres.
void find_depths(const TriangleMesh& mesh, OrientedMesh& out, int threads) {
  constexpr int kSamples = 7;
  constexpr std::size_t kComponentsAtOnce = 64;
  const std::vector<bool> asked = neighbours_by_box(out.components, threads);
  if (std::find(asked.begin(), asked.end(), true) == asked.end()) return;
  std::vector<std::vector<int>> members(out.components.size());
  std::vector<int> surface = out.component;
  for (std::size_t t = 0; t < surface.size(); ++t) {
    if (asked[surface[t]]) {
      members[surface[t]].push_back(static_cast<int>(t));
    } else {
      surface[t] = -1;
    }
  }
  const SurfaceCrossings crossings(mesh, surface, threads);
  for_ranges(threads, members.size(), kComponentsAtOnce, [&](std::size_t first, std::size_t last) {
    std::vector<int> around;
    for (std::size_t c = first; c < last; ++c) {
      const int count = static_cast<int>(std::min<std::size_t>(kSamples, members[c].size()));
      around.clear();
      for (int i = 0; i < count; ++i) {
        const Triangle& t = mesh.triangles[members[c][members[c].size() * i / count]];
        const Vec3 center = (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3.0;
        for (const auto& [other, winding] : crossings.windings(center))
          if (other != static_cast<int>(c)) around.push_back(other);
      }
      take_depth(around, count, out.components[c]);
    }
  });
}

}  // namespace

bool MeshComponent::empty_inside() const {
  return closed && std::abs(volume) <= tolerances::kNoVolume * std::pow(box.diagonal(), 3);
}

OrientedMesh orient_components(TriangleMesh& mesh, int threads) {
  OrientedMesh out;
  out.component.assign(mesh.triangles.size(), -1);
  const std::vector<HalfEdge> sides = sorted_half_edges(mesh);
  std::vector<bool> turned = flood(neighbours_of(sides, mesh.triangles.size()), out);
  report_edges(sides, turned, out);
  join_open_patches(mesh, sides, turned, out, threads);
  for (std::size_t t = 0; t < turned.size(); ++t)
    if (turned[t]) turn(mesh.triangles[t]);
  const std::vector<double> turned_area = measure(mesh, turned, out);
  find_depths(mesh, out, threads);
  std::vector<bool> turn_whole(out.components.size(), false);
  for (std::size_t c = 0; c < out.components.size(); ++c) {
    MeshComponent& component = out.components[c];
    const bool minority = turned_area[c] > 0.5 * component.area;
    const bool cavity = component.depth % 2 != 0;
    turn_whole[c] = encloses(component) ? (component.volume < 0.0) != cavity : minority;
    if (turn_whole[c]) component.volume = -component.volume;
  }
  for (std::size_t t = 0; t < turned.size(); ++t) {
    if (!turn_whole[out.component[t]]) continue;
    turn(mesh.triangles[t]);
    turned[t] = !turned[t];
  }
  for (std::size_t t = 0; t < turned.size(); ++t)
    if (turned[t]) out.flipped.push_back(static_cast<int>(t));
  return out;
}

}  // namespace tactum::inline v0_1
