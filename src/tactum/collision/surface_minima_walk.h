#pragma once
/// Down the trees of two surfaces at once: a box against eight, then eight features against eight, then what
/// is left one by one and exactly.

#include <array>

#include "tactum/collision/surface_minima_features.h"
#include "tactum/collision/surface_minima_leaves.h"

namespace tactum {

/// Boxes and leaves in the form the tests want, kept for the pairs that follow, which mostly ask for the same
/// again. The room is filled as far as it is used.
template <class Value, std::size_t Room>
class Kept {
 public:
  Kept() noexcept { key_.fill(-1); }  // NOLINT(cppcoreguidelines-pro-type-member-init)
  /// The value with this key, which make(value) makes when it is not there.
  template <class Make>
  const Value& get(std::int32_t key, const Make& make) noexcept {
    const std::size_t slot = std::size_t(key) % Room;
    if (key_[slot] != key) {
      key_[slot] = key;
      make(value_[slot]);
    }
    return value_[slot];
  }

 private:
  std::array<std::int32_t, Room> key_;
  std::array<Value, Room> value_;
};

/// Everything is told in B's frame, from B's center; only boxes of B that are held against A's nodes are told
/// in A's.
class SurfaceWalk {
 public:
  SurfaceWalk(const SurfaceTree& a, const SurfaceTree& b, const Pose& X_AB, const lanes::Bounds& bounds,
              const lanes::Kernels& kernels, FeatureComparison& features) noexcept;
  /// All minima of features of one kind of A with those of another kind of B.
  void run(SurfaceTree::Kind kind_a, SurfaceTree::Kind kind_b) noexcept;

 private:
  using Index = std::size_t;
  using Set = std::uint32_t;

  /// A lane of a node: its number among all, what is below, and half the longest side of its box.
  struct Place {
    std::int32_t lane, child;
    float extent;
  };
  struct Pair {
    Place a, b;
  };
  /// The leaves of one surface in lanes.
  struct Leaves {
    Kept<lanes::Vertices, 128> vertices;
    Kept<lanes::Edges, 128> edges;
    Kept<lanes::Faces, 64> faces;
  };
  static Place place(const SurfaceTree& tree, std::int32_t node, int lane) noexcept;
  static Vec3 middle(const SurfaceTree& tree, const Place& at) noexcept;
  const lanes::Box& box_of_a(const Place& at) noexcept;
  const lanes::Box& box_of_b(const Place& at) noexcept;
  const lanes::Box& box_of_b_in_a(const Place& at) noexcept;
  template <class Lanes>
  void put(const Place& at, bool of_a, Lanes& to) noexcept;
  const lanes::Vertices& vertices(const Place& at, bool of_a) noexcept;
  const lanes::Edges& edges(const Place& at, bool of_a) noexcept;
  const lanes::Faces& faces(const Place& at, bool of_a) noexcept;

  void compare_leaves(const Pair& pair) noexcept;
  void compare_edges(const Pair& pair, const lanes::Three& off) noexcept;
  /// The vertices of a leaf of A, or else of B, with the other's features; `off`: from the middle of the
  /// other's leaf to that of theirs [m].
  void compare_vertices(const Pair& pair, bool of_a, const lanes::Three& off) noexcept;

  const SurfaceTree& a_;
  const SurfaceTree& b_;
  Pose X_BA_;  // from center to center
  lanes::Frame a_in_b_, b_in_a_;
  const lanes::Bounds& bounds_;
  const lanes::Kernels& kernels_;
  FeatureComparison& features_;
  SurfaceTree::Kind kind_a_{}, kind_b_{};
  Kept<lanes::Box, 64> boxes_a_, boxes_b_, boxes_b_in_a_;
  Leaves leaves_a_, leaves_b_;
};

}  // namespace tactum
