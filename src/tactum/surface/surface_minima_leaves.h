#pragma once
/// The features of a leaf of a SurfaceTree in lanes, as surface_minima_lanes.h reads them. A tree stores
/// which features a leaf holds and nothing else: their coordinates are read from the mesh when a query first
/// needs them, which costs about as much as one comparison of two leaves.

#include "tactum/surface/surface_minima_lanes.h"

namespace tactum::inline v0_1::lanes {

/// Which leaf is under a box; `box.at` is not read.
inline std::uint32_t leaf_under(const Box& box) noexcept {
  return static_cast<std::uint32_t>(~box.node->child[box.lane]);
}

/// In the frame of the leaf's own tree.
void gather_leaf(const SurfaceTree& tree, const Box& box, VertexLeaf& leaf) noexcept;
void gather_leaf(const SurfaceTree& tree, const Box& box, const Kernels& kernels, EdgeLeaf& leaf) noexcept;
/// Limits grown by that length [m].
void gather_leaf(const SurfaceTree& tree, const Box& box, const Kernels& kernels, float grown,
                 FaceLeaf& leaf) noexcept;

}  // namespace tactum::inline v0_1::lanes
