#pragma once
/// The walk down the trees of two surfaces at once: a box against eight, then eight features against eight,
/// then the pairs that are left one by one and exactly.

#include <array>

#include "tactum/surface/kept.h"
#include "tactum/surface/surface_minima_features.h"
#include "tactum/surface/surface_minima_lanes.h"

namespace tactum::inline v0_1 {

/// Everything is in the frame of the other surface, from its center.
class SurfaceWalk {
 public:
  /// One surface and the other with the one at X_OtherOne. `swapped`: the one is B.
  SurfaceWalk(const SurfaceTree& one, const SurfaceTree& other, const Pose& X_OtherOne, bool swapped,
              lanes::Bounds& bounds, const lanes::Kernels& kernels, FeatureComparison& features) noexcept;
  /// All minima of edges with edges, or of vertices of the one with features of the other.
  template <SurfaceTree::Kind One, SurfaceTree::Kind Other>
  void run() noexcept;

 private:
  using Index = std::size_t;
  using Set = std::uint32_t;

  /// A lane of a node, as its number among all, of either tree.
  struct Pair {
    std::uint32_t one, other;
  };
  static const SurfaceTree::Node& node_of(const SurfaceTree& tree, std::uint32_t lane) noexcept {
    return tree.nodes()[lane / lanes::kLanes];
  }
  lanes::Box box_of_one(std::uint32_t lane) noexcept {
    return {&node_of(one_, lane), &turned(lane / lanes::kLanes), lane % lanes::kLanes};
  }
  lanes::Box box_of_other(std::uint32_t lane) const noexcept {
    const SurfaceTree::Node& node = node_of(other_, lane);
    return {&node, &node.at, lane % lanes::kLanes};
  }
  /// The boxes of a node of the one in the other's frame.
  const SurfaceTree::Stand& turned(std::uint32_t node) noexcept {
    return stands_.get(
        node, [&](SurfaceTree::Stand& to) { kernels_.turn_stand(one_.nodes()[node].at, frame_, to); });
  }

  template <SurfaceTree::Kind One, SurfaceTree::Kind Other>
  void compare_leaves(const Pair& pair) noexcept;
  /// Gathered leaves, those of the one in the other's frame.
  template <SurfaceTree::Kind Kind>
  const auto& leaf_of_one(const lanes::Box& box) noexcept;
  template <SurfaceTree::Kind Kind>
  const auto& leaf_of_other(const lanes::Box& box) noexcept;

  const SurfaceTree& one_;
  const SurfaceTree& other_;
  bool swapped_;
  lanes::Frame frame_;
  lanes::Bounds& bounds_;  // narrower when the features are
  const lanes::Kernels& kernels_;
  FeatureComparison& features_;
  template <class Value>
  using Some = Kept<Value, 64>;
  Kept<SurfaceTree::Stand, 128> stands_;
  Some<lanes::VertexLeaf> vertices_of_one_, vertices_of_other_;
  Some<lanes::EdgeLeaf> edges_of_one_, edges_of_other_;
  Some<lanes::FaceLeaf> faces_of_other_;
};

}  // namespace tactum::inline v0_1
