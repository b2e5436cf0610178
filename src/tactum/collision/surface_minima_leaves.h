#pragma once
/// The features of a leaf in eight lanes of single precision, told from the middle of the leaf's box, so that
/// it is good to a millionth of the leaf.

#include "tactum/collision/surface_minima_bounds.h"

namespace tactum::lanes {

void put_lanes(const SurfaceTree& tree, const SurfaceTree::Leaf& leaf, const Vec3& middle, const Bounds& q,
               Vertices& lanes) noexcept;
void put_lanes(const SurfaceTree& tree, const SurfaceTree::Leaf& leaf, const Vec3& middle, const Bounds& q,
               Edges& lanes) noexcept;
void put_lanes(const SurfaceTree& tree, const SurfaceTree::Leaf& leaf, const Vec3& middle, const Bounds& q,
               Faces& lanes) noexcept;

/// The same in the other tree's frame, from the same middle.
void turn(Vertices& lanes, const Frame& frame) noexcept;
void turn(Edges& lanes, const Frame& frame) noexcept;
void turn(Faces& lanes, const Frame& frame) noexcept;

}  // namespace tactum::lanes
