#include "tactum/collision/surface_minima_walk.h"

#include <algorithm>
#include <bit>

namespace tactum {
namespace {

using lanes::kLanes;
using Tree = SurfaceTree;

/// Of two boxes the larger is opened, or rather the one with the wider cone: its children face less. Beside
/// this angle widths do not count [rad].
constexpr float kNarrow = 0.02F;

constexpr std::size_t kStack = 256;  // eleven levels of each, seven more pairs a level

const Tree::Leaf& leaf(const Tree& tree, std::int32_t child) noexcept {
  return tree.leaves()[std::size_t(~child)];
}

/// Calls compare(one's corner, other's corner) for the matches of the ones that are near the other leaf.
template <class Compare>
void for_each_match(const Tree::Leaf& ones, const Tree::Leaf& many, std::uint32_t near,
                    const lanes::Matches& matches, const Compare& compare) noexcept {
  for (; near != 0; near &= near - 1) {
    const std::size_t i = std::size_t(std::countr_zero(near));
    for (std::uint32_t bits = matches[i]; bits != 0; bits &= bits - 1)
      compare(ones.corner[i], many.corner[std::size_t(std::countr_zero(bits))]);
  }
}

lanes::Three in_single(const Vec3& v) noexcept {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

/// From one tree's center, in the other's frame from its center.
Pose between_centers(const Tree& from, const Tree& to, const Pose& X) noexcept {
  return {X.R, X * from.center() - to.center()};
}

}  // namespace

SurfaceWalk::SurfaceWalk(const Tree& a, const Tree& b, const Pose& X_AB, const lanes::Bounds& bounds,
                         const lanes::Kernels& kernels, FeatureComparison& features) noexcept
    : a_(a),
      b_(b),
      X_BA_(between_centers(a, b, X_AB.inverse())),
      a_in_b_(X_BA_),
      b_in_a_(between_centers(b, a, X_AB)),
      bounds_(bounds),
      kernels_(kernels),
      features_(features) {}

void SurfaceWalk::run(Tree::Kind kind_a, Tree::Kind kind_b) noexcept {
  if (a_.root(kind_a) < 0 || b_.root(kind_b) < 0) return;
  kind_a_ = kind_a;
  kind_b_ = kind_b;
  // Filled as far as it is used: NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init)
  std::array<Pair, kStack> stack;
  Index size = 0;
  stack[size++] = {place(a_, a_.root(kind_a), 0), place(b_, b_.root(kind_b), 0)};
  while (size > 0) {
    const Pair pair = stack[--size];
    if (pair.a.child < 0 && pair.b.child < 0) {
      compare_leaves(pair);
      continue;
    }
    const bool open_a = pair.b.child < 0 || (pair.a.child >= 0 && pair.a.extent > pair.b.extent);
    features_.work.box_tests += int(kLanes);
    const Tree& tree = open_a ? a_ : b_;
    const std::int32_t opened = open_a ? pair.a.child : pair.b.child;
    Set bits = kernels_.facing(open_a ? box_of_b_in_a(pair.b) : box_of_a(pair.a), tree.nodes()[Index(opened)],
                               bounds_);
    for (; bits != 0; bits &= bits - 1) {
      if (size == kStack) {  // deeper than any tree is built
        features_.work.full = true;
        return;
      }
      const Place below = place(tree, opened, std::countr_zero(bits));
      stack[size++] = open_a ? Pair{below, pair.b} : Pair{pair.a, below};
    }
  }
}

SurfaceWalk::Place SurfaceWalk::place(const Tree& tree, std::int32_t node, int lane) noexcept {
  const Tree::Node& n = tree.nodes()[Index(node)];
  const Index k = Index(lane);
  return {int(kLanes) * node + lane, n.child[k],
          (kNarrow + n.cone[k]) * std::max({n.half[0][k], n.half[1][k], n.half[2][k]})};
}

Vec3 SurfaceWalk::middle(const Tree& tree, const Place& at) noexcept {
  const lanes::Lanes3& center = tree.nodes()[Index(at.lane) / kLanes].center;
  const Index k = Index(at.lane) % kLanes;
  return {center[0][k], center[1][k], center[2][k]};
}

const lanes::Box& SurfaceWalk::box_of_a(const Place& at) noexcept {
  return boxes_a_.get(at.lane, [&](lanes::Box& to) {
    to = lanes::box_of(a_.nodes()[Index(at.lane) / kLanes], Index(at.lane) % kLanes, bounds_, a_in_b_);
  });
}
const lanes::Box& SurfaceWalk::box_of_b(const Place& at) noexcept {
  return boxes_b_.get(at.lane, [&](lanes::Box& to) {
    to = lanes::box_of(b_.nodes()[Index(at.lane) / kLanes], Index(at.lane) % kLanes, bounds_);
  });
}
const lanes::Box& SurfaceWalk::box_of_b_in_a(const Place& at) noexcept {
  return boxes_b_in_a_.get(at.lane, [&](lanes::Box& to) {
    to = lanes::box_of(b_.nodes()[Index(at.lane) / kLanes], Index(at.lane) % kLanes, bounds_, b_in_a_);
  });
}

template <class Lanes>
void SurfaceWalk::put(const Place& at, bool of_a, Lanes& to) noexcept {
  const Tree& tree = of_a ? a_ : b_;
  lanes::put_lanes(tree, leaf(tree, at.child), middle(tree, at), bounds_, to);
  if (of_a) lanes::turn(to, a_in_b_);
}

const lanes::Vertices& SurfaceWalk::vertices(const Place& at, bool of_a) noexcept {
  return (of_a ? leaves_a_ : leaves_b_).vertices.get(~at.child, [&](auto& to) { put(at, of_a, to); });
}
const lanes::Edges& SurfaceWalk::edges(const Place& at, bool of_a) noexcept {
  return (of_a ? leaves_a_ : leaves_b_).edges.get(~at.child, [&](auto& to) { put(at, of_a, to); });
}
const lanes::Faces& SurfaceWalk::faces(const Place& at, bool of_a) noexcept {
  return (of_a ? leaves_a_ : leaves_b_).faces.get(~at.child, [&](auto& to) { put(at, of_a, to); });
}

void SurfaceWalk::compare_leaves(const Pair& pair) noexcept {
  ++features_.work.leaf_pairs;
  const Vec3 apart = X_BA_ * middle(a_, pair.a) - middle(b_, pair.b);
  if (kind_a_ == Tree::kEdges && kind_b_ == Tree::kEdges) {
    compare_edges(pair, in_single(apart));
  } else if (kind_a_ == Tree::kVertices) {
    compare_vertices(pair, true, in_single(apart));
  } else {
    compare_vertices(pair, false, in_single(-apart));
  }
}

/// Of either leaf only the edges near the other's box, and from the side that has fewer.
void SurfaceWalk::compare_edges(const Pair& pair, const lanes::Three& off) noexcept {
  const lanes::Edges& of_a = edges(pair.a, true);
  const Set near_a = kernels_.edges_near(of_a, off, box_of_b(pair.b));
  if (near_a == 0) return;
  const lanes::Edges& of_b = edges(pair.b, false);
  const lanes::Three back = {-off[0], -off[1], -off[2]};
  const Set near_b = kernels_.edges_near(of_b, back, box_of_a(pair.a));
  if (near_b == 0) return;
  const Tree::Leaf& leaf_a = leaf(a_, pair.a.child);
  const Tree::Leaf& leaf_b = leaf(b_, pair.b.child);
  lanes::Matches matches{};
  const auto keep = [&](Set near) {
    for (std::uint8_t& bits : matches) bits &= static_cast<std::uint8_t>(near);
  };
  if (std::popcount(near_a) <= std::popcount(near_b)) {
    kernels_.edge_edge(of_a, off, near_a, of_b, bounds_, matches);
    keep(near_b);
    for_each_match(leaf_a, leaf_b, near_a, matches,
                   [&](std::int32_t a, std::int32_t b) { features_.edge_edge(a, b); });
  } else {
    kernels_.edge_edge(of_b, back, near_b, of_a, bounds_, matches);
    keep(near_a);
    for_each_match(leaf_b, leaf_a, near_b, matches,
                   [&](std::int32_t b, std::int32_t a) { features_.edge_edge(a, b); });
  }
}

void SurfaceWalk::compare_vertices(const Pair& pair, bool of_a, const lanes::Three& off) noexcept {
  const Place& one = of_a ? pair.a : pair.b;
  const Place& other = of_a ? pair.b : pair.a;
  const lanes::Vertices& ones = vertices(one, of_a);
  const Set near = kernels_.vertices_near(ones, off, of_a ? box_of_b(other) : box_of_a(other));
  if (near == 0) return;
  lanes::Matches matches{};
  const auto each = [&](const auto& compare) {
    for_each_match(leaf(of_a ? a_ : b_, one.child), leaf(of_a ? b_ : a_, other.child), near, matches,
                   compare);
  };
  const Tree::Kind kind = of_a ? kind_b_ : kind_a_;
  if (kind == Tree::kFaces) {
    kernels_.vertex_face(ones, off, near, faces(other, !of_a), bounds_, matches);
    each([&](std::int32_t v, std::int32_t f) { features_.vertex_face(!of_a, v, f); });
  } else if (kind == Tree::kEdges) {
    kernels_.vertex_edge(ones, off, near, edges(other, !of_a), bounds_, matches);
    each([&](std::int32_t v, std::int32_t e) { features_.vertex_edge(!of_a, v, e); });
  } else {
    kernels_.vertex_vertex(ones, off, near, vertices(other, !of_a), bounds_, matches);
    each([&](std::int32_t a, std::int32_t b) { features_.vertex_vertex(a, b); });
  }
}

}  // namespace tactum
