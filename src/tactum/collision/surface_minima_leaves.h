#pragma once
/// Which of the eight features of a leaf may be a minimum with a given feature: by place alone, for the exact
/// test of the few that are left tells the rest. All in the frame of the lanes' tree, from the middle of a
/// leaf's box, so that single precision is good to a millionth of the leaf.

#include "tactum/collision/surface_minima_bounds.h"

namespace tactum::lanes {

/// The features of a leaf in eight lanes, told from the middle of its box; lanes without a feature are far
/// away.
struct Vertices {
  SurfaceTree::Lanes3 point;
};
struct Edges {
  SurfaceTree::Lanes3 point, along;  ///< where it starts, and from there to its end
};
struct Faces {
  SurfaceTree::Lanes3 normal;
  std::array<SurfaceTree::Lanes3, 3> corner;
};
void put_lanes(const SurfaceTree& tree, const SurfaceTree::Leaf& leaf, const Vec3& middle,
               Vertices& lanes) noexcept;
void put_lanes(const SurfaceTree& tree, const SurfaceTree::Leaf& leaf, const Vec3& middle,
               Edges& lanes) noexcept;
void put_lanes(const SurfaceTree& tree, const SurfaceTree::Leaf& leaf, const Vec3& middle,
               Faces& lanes) noexcept;

/// The same in the other tree's frame, from the same middle.
void turn(Vertices& lanes, const Frame& frame) noexcept;
void turn(Edges& lanes, const Frame& frame) noexcept;

/// A bit a lane: whether the feature, moved by `off`, overlaps the box along the box's own axes when padded.
std::uint32_t near_box(const Vertices& lanes, const Three& off, const Box& box, const Bounds& q) noexcept;
std::uint32_t near_box(const Edges& lanes, const Three& off, const Box& box, const Bounds& q) noexcept;

/// A bit a lane: `point` (and `along`) of a single, told from the lanes' middle.
std::uint32_t near_vertex(const Three& point, const Vertices& lanes, const Bounds& q) noexcept;
std::uint32_t near_vertex(const Three& point, const Edges& lanes, const Bounds& q) noexcept;
std::uint32_t near_vertex(const Three& point, const Faces& lanes, const Bounds& q) noexcept;
std::uint32_t near_edge(const Three& point, const Three& along, const Edges& lanes, const Bounds& q) noexcept;

}  // namespace tactum::lanes
