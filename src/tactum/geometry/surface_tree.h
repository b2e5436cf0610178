#pragma once
/// A triangle surface for queries of surface against surface: its features with their normal cones, each kind
/// under a tree of oriented boxes, eight children a node.
///
///      convex edge: u between n1 and n2      vertex: every edge falls         boundary: as if a wall went
///              n1  u  n2                     away from u (polar cone)         back from the rim
///                \ | /                                 u                          n   u
///          ______ \|/                                  |                          |  /
///                  *______                          /\_*_/\.                ______|/___
///                                                                                 : wall
/// A direction u is in a feature's normal cone when, from the feature, the surface falls away from u on all
/// sides: only there can the feature be nearest to something outside. Faces have one direction, their outward
/// normal. Features without a cone are not stored and cost nothing: reflex edges, pits and saddles, and the
/// edges and vertices inside a flat face (coplanar_groups.h), which would be felt as internal contacts.
///
/// Edges of one triangle, of more than two, and of two that disagree about outside are rims of each of their
/// triangles: the surface is closed there by a wall straight behind it, so a rim is felt from the front and
/// from the side, never from behind. The only condition on the mesh is that triangles have an area.
///
/// Numbers of features: vertices and triangles keep the numbers of the mesh; the edge from corner k of
/// triangle t to the next corner is 3 t + k, numbered by the one of its two triangles that owns it.
///
/// Memory: at most 120 bytes a triangle on closed meshes, all of it in flat arrays of plain data that a file
/// can hold as they are. Building: n log n, some microseconds a triangle, with some 500 bytes a
/// triangle for a while.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "tactum/base/large_array.h"
#include "tactum/geometry/surface_layout.h"
#include "tactum/geometry/triangle_mesh.h"

namespace tactum::inline v0_1 {

class SurfaceTree : public SurfaceLayout {
 public:
  SurfaceTree() = default;
  /// Over a mesh whose triangles have three different corners and an area (weld() sees to it), outward.
  explicit SurfaceTree(const TriangleMesh& welded);
  /// The same with the flat faces found already: `group` of each triangle, as coplanar_groups() numbers them.
  /// The same tree for any number of threads.
  SurfaceTree(const TriangleMesh& welded, const std::vector<int>& group, int threads = 1);

  bool empty() const noexcept { return triangles_.empty(); }
  double size() const noexcept { return scalars_.size; }  ///< diagonal of the bounding box [m]
  std::size_t memory() const noexcept;                    ///< of the arrays [bytes]
  int triangle_count() const noexcept { return static_cast<int>(triangles_.size()); }
  int vertex_count() const noexcept { return static_cast<int>(vertices_.size()); }

  const Vec3& vertex(int index) const noexcept { return vertices_[std::size_t(index)]; }  ///< [m]
  const Triangle& triangle(int index) const noexcept { return triangles_[std::size_t(index)]; }
  /// The flat face that a triangle belongs to.
  int group_of(int triangle) const noexcept { return group_[std::size_t(triangle)]; }
  /// The two vertices of an edge, in the order of its owner.
  std::array<int, 2> edge(int index) const noexcept {
    const Triangle& t = triangle(index / 3);
    return {t[std::size_t(index % 3)], t[std::size_t((index + 1) % 3)]};
  }

  // ---- what the query reads ----

  const LargeArray<Node>& nodes() const noexcept { return nodes_; }
  /// Leaves hold eight features of one kind as corners 3 t + k of the triangles that own them: a vertex is
  /// that corner, an edge starts there, a face is the triangle, k = 0. -1: none, behind all others.
  const LargeArray<Corners>& leaves() const noexcept { return leaves_; }
  /// The node whose first lane is the box around all vertices, edges or faces; -1: there are none. Nodes of a
  /// kind stand together, the root before the others.
  std::int32_t root(Kind kind) const noexcept { return scalars_.root[kind]; }

  int vertex_at(std::int32_t corner) const noexcept {
    return triangles_[std::size_t(corner) / 3][std::size_t(corner) % 3];
  }

  /// For the features a triangle owns, one bit for each of its three edges, then each of its three corners:
  /// whether it is narrow, that is, no direction of its cone lies behind the triangle.
  bool narrow_edge(std::int32_t corner) const noexcept { return narrow_bit(corner, 0); }
  bool narrow_vertex(std::int32_t corner) const noexcept { return narrow_bit(corner, 3); }

  /// Beyond the edge that starts at a corner and belongs to its triangle: the vertex of the neighbour that is
  /// not on the edge, or kWall at a rim.
  std::int32_t beyond(std::int32_t corner) const noexcept {
    return beyond_[std::size_t(corner) / 3][std::size_t(corner) % 3];
  }

  /// The directions that must fall away from a direction of an owned vertex's cone: the vertices at the other
  /// ends of its edges, and ~t for the wall behind a rim of triangle t.
  std::span<const std::int32_t> around(int vertex) const noexcept {
    const auto first = std::size_t(first_around_[std::size_t(vertex)]);
    return {around_.data() + first, std::size_t(first_around_[std::size_t(vertex) + 1]) - first};
  }

  /// Plain data beside the arrays.
  struct Scalars {
    double size = 0.0;                            ///< [m]
    std::array<double, 3> center{0.0, 0.0, 0.0};  ///< of the bounding box [m]
    std::array<std::int32_t, 3> root{-1, -1, -1};
    std::int32_t unused = -1;  ///< keeps bytes without a meaning out of files
  };
  const Scalars& scalars() const noexcept { return scalars_; }
  Scalars& scalars() noexcept { return scalars_; }
  Vec3 center() const noexcept { return {scalars_.center[0], scalars_.center[1], scalars_.center[2]}; }

  /// Calls visitor(vector) for every array, always in the same order, so that a file can write and read the
  /// tree without knowing it. After reading, call sound().
  template <class Visitor>
  void for_each_array(Visitor&& visitor) {
    arrays(*this, visitor);
  }
  template <class Visitor>
  void for_each_array(Visitor&& visitor) const {
    arrays(*this, visitor);
  }
  /// Whether every index points into its array and every walk ends, which a damaged file could violate.
  /// Linear.
  bool sound() const noexcept;

 private:
  /// Whether nodes [first, last) of one kind point behind themselves and to leaves that there are.
  bool sound(std::int32_t first, std::int32_t last) const noexcept;

  template <class Self, class Visitor>
  static void arrays(Self& self, Visitor&& visitor) {
    visitor(self.vertices_);
    visitor(self.triangles_);
    visitor(self.group_);
    visitor(self.beyond_);
    visitor(self.narrow_);
    visitor(self.first_around_);
    visitor(self.around_);
    visitor(self.nodes_);
    visitor(self.leaves_);
  }

  bool narrow_bit(std::int32_t corner, std::uint32_t first) const noexcept {
    return (narrow_[std::size_t(corner) / 3] >> (first + std::uint32_t(corner) % 3) & 1u) != 0;
  }

  Scalars scalars_;
  std::vector<Vec3> vertices_;
  std::vector<Triangle> triangles_;
  std::vector<std::int32_t> group_;
  std::vector<std::array<std::int32_t, 3>> beyond_;
  std::vector<std::uint8_t> narrow_;
  std::vector<std::int32_t> first_around_;  // per vertex, and the end
  std::vector<std::int32_t> around_;
  LargeArray<Node> nodes_;
  LargeArray<Corners> leaves_;
};

}  // namespace tactum::inline v0_1
