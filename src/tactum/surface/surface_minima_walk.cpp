#include "tactum/surface/surface_minima_walk.h"

#include <algorithm>
#include <bit>

#include "tactum/surface/surface_minima_leaves.h"

namespace tactum::inline v0_1 {
namespace {

using lanes::kLanes;
using Tree = SurfaceTree;

constexpr std::size_t kStack = 256;  // eleven levels of each, seven more pairs a level

/// From one tree's center, in the other's frame from its center.
Pose between_centers(const Tree& from, const Tree& to, const Pose& X) noexcept {
  return {X.R, X * from.center() - to.center()};
}

}  // namespace

SurfaceWalk::SurfaceWalk(const Tree& one, const Tree& other, const Pose& X_OtherOne, bool swapped,
                         lanes::Bounds& bounds, const lanes::Kernels& kernels,
                         FeatureComparison& features) noexcept
    : one_(one),
      other_(other),
      swapped_(swapped),
      frame_(between_centers(one, other, X_OtherOne)),
      bounds_(bounds),
      kernels_(kernels),
      features_(features) {}

template <Tree::Kind One, Tree::Kind Other>
void SurfaceWalk::run() noexcept {
  if (one_.root(One) < 0 || other_.root(Other) < 0) return;
  // Filled as far as it is used: NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init)
  std::array<Pair, kStack> stack;
  Index size = 0;
  const auto take = [&](const Pair& pair, bool leaves) {
    if (leaves) {
      compare_leaves<One, Other>(pair);
    } else {
      stack[size++] = pair;
    }
  };
  const Pair root = {std::uint32_t(kLanes) * std::uint32_t(one_.root(One)),
                     std::uint32_t(kLanes) * std::uint32_t(other_.root(Other))};
  take(root, node_of(one_, root.one).child[0] < 0 && node_of(other_, root.other).child[0] < 0);
  while (size > 0) {
    const Pair pair = stack[--size];
    const Tree::Node& one = node_of(one_, pair.one);
    const Tree::Node& other = node_of(other_, pair.other);
    const Index i = pair.one % kLanes;
    const Index k = pair.other % kLanes;
    const bool open_one = other.child[k] < 0 || (one.child[i] >= 0 && one.extent[i] > other.extent[k]);
    const auto opened = std::uint32_t(open_one ? one.child[i] : other.child[k]);
    const bool unopened_is_leaf = (open_one ? other.child[k] : one.child[i]) < 0;
    const Tree::Node& node = (open_one ? one_ : other_).nodes()[opened];
    features_.work.box_tests += int(kLanes);
    Set bits = open_one ? kernels_.facing(box_of_other(pair.other), node, turned(opened), bounds_)
                        : kernels_.facing(box_of_one(pair.one), node, node.at, bounds_);
    if (size + kLanes > kStack) {  // deeper than any tree is built
      features_.work.full = true;
      return;
    }
    for (; bits != 0; bits &= bits - 1) {
      const auto lane = std::uint32_t(std::countr_zero(bits));
      const std::uint32_t below = std::uint32_t(kLanes) * opened + lane;
      take(open_one ? Pair{below, pair.other} : Pair{pair.one, below},
           unopened_is_leaf && node.child[lane] < 0);
    }
  }
}

template <Tree::Kind Kind>
const auto& SurfaceWalk::leaf_of_one(const lanes::Box& box) noexcept {
  if constexpr (Kind == Tree::kEdges) {
    return edges_of_one_.get(lanes::leaf_under(box), [&](lanes::EdgeLeaf& leaf) {
      lanes::gather_leaf(one_, box, kernels_, leaf);
      kernels_.turn_edges(frame_, leaf);
    });
  } else {
    return vertices_of_one_.get(lanes::leaf_under(box), [&](lanes::VertexLeaf& leaf) {
      lanes::gather_leaf(one_, box, leaf);
      kernels_.turn_vertices(frame_, leaf);
    });
  }
}

template <Tree::Kind Kind>
const auto& SurfaceWalk::leaf_of_other(const lanes::Box& box) noexcept {
  const std::uint32_t index = lanes::leaf_under(box);
  if constexpr (Kind == Tree::kFaces) {
    return faces_of_other_.get(index, [&](lanes::FaceLeaf& leaf) {
      lanes::gather_leaf(other_, box, kernels_, bounds_.grown, leaf);
    });
  } else if constexpr (Kind == Tree::kEdges) {
    return edges_of_other_.get(
        index, [&](lanes::EdgeLeaf& leaf) { lanes::gather_leaf(other_, box, kernels_, leaf); });
  } else {
    return vertices_of_other_.get(index,
                                  [&](lanes::VertexLeaf& leaf) { lanes::gather_leaf(other_, box, leaf); });
  }
}

template <Tree::Kind One, Tree::Kind Other>
void SurfaceWalk::compare_leaves(const Pair& pair) noexcept {
  ++features_.work.leaf_pairs;
  const lanes::Box box_one = box_of_one(pair.one);
  const lanes::Box box_other = box_of_other(pair.other);
  const auto apart = [&](Index axis) {
    return box_one.at->center[axis][box_one.lane] - box_other.at->center[axis][box_other.lane];
  };
  const lanes::Three off = {apart(0), apart(1), apart(2)};
  // Often no feature of the one leaf is near the other's box, and the other need not be gathered.
  const auto& ones = leaf_of_one<One>(box_one);
  lanes::Matches left = 0;
  if constexpr (One == Tree::kEdges) {
    const Set some = kernels_.edges_near(ones, off, box_other, bounds_);
    if (some == 0) return;
    const auto& others = leaf_of_other<Other>(box_other);
    const Set some_others = kernels_.edges_near(others, {-off[0], -off[1], -off[2]}, box_one, bounds_);
    if (some_others == 0) return;
    left = kernels_.edge_edge(ones, some, off, others, some_others, bounds_);
  } else {
    const Set some = kernels_.vertices_near(ones, off, box_other, bounds_);
    if (some == 0) return;
    const auto& others = leaf_of_other<Other>(box_other);
    if constexpr (Other == Tree::kVertices) left = kernels_.vertex_vertex(ones, some, off, others, bounds_);
    if constexpr (Other == Tree::kEdges) left = kernels_.vertex_edge(ones, some, off, others, bounds_);
    if constexpr (Other == Tree::kFaces) left = kernels_.vertex_face(ones, some, off, others, bounds_);
  }
  if (left == 0) return;
  for (; left != 0; left &= left - 1) {
    const Index bit = Index(std::countr_zero(left));
    const std::int32_t one = one_.leaves()[lanes::leaf_under(box_one)][bit / kLanes];
    const std::int32_t other = other_.leaves()[lanes::leaf_under(box_other)][bit % kLanes];
    if constexpr (One == Tree::kEdges) features_.edge_edge(one, other);
    if constexpr (One == Tree::kVertices && Other == Tree::kFaces)
      features_.vertex_face(swapped_, one, other);
    if constexpr (One == Tree::kVertices && Other == Tree::kEdges)
      features_.vertex_edge(swapped_, one, other);
    if constexpr (One == Tree::kVertices && Other == Tree::kVertices) features_.vertex_vertex(one, other);
  }
  bounds_.max_distance = static_cast<float>(features_.max_distance()) + bounds_.grown;
  bounds_.far = std::max(bounds_.max_distance, bounds_.depth);
}

template void SurfaceWalk::run<Tree::kEdges, Tree::kEdges>() noexcept;
template void SurfaceWalk::run<Tree::kVertices, Tree::kFaces>() noexcept;
template void SurfaceWalk::run<Tree::kVertices, Tree::kEdges>() noexcept;
template void SurfaceWalk::run<Tree::kVertices, Tree::kVertices>() noexcept;

}  // namespace tactum::inline v0_1
