#pragma once
/// The quick half of surface_minima.h: which of eight boxes, or features, may have to do with one. Single
/// precision, eight lanes at once where the processor has AVX2, else twice four. Every lane is plain IEEE
/// arithmetic in one order, so the answers are the same bits on every build and processor; they err on the
/// safe side only, and what they let through is tested exactly.
///
///     leaf of one        box of the other's leaf         leaf of the other
///     eight features ──► which are near it? ──► each against eight: a bit for a pair that may be a minimum
///
/// Everything is told in the frame of the other tree, from its center. Nodes and leaves of the one are turned
/// into it eight lanes at a time; those of the other are taken as they are stored.

#include <array>
#include <cstdint>

#include "tactum/geometry/surface_tree.h"
#include "tactum/math/pose.h"

namespace tactum::lanes {

inline constexpr std::size_t kLanes = SurfaceTree::kLanes;
using Lanes = SurfaceTree::Lanes;
using Lanes3 = SurfaceTree::Lanes3;
using Three = std::array<float, 3>;

/// What every quick test needs of the query, grown so that rounding loses nothing.
struct Bounds {
  float reach, depth, far;  ///< far: the larger of the two [m]
  float slack;              ///< of one cone [rad]
  float grown;              ///< by which lengths are grown [m]
};

/// The pose of one tree's center in the other's, in single precision.
struct Frame {
  std::array<Three, 3> R{};
  Three p{};
  explicit Frame(const Pose& X) noexcept {
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) R[i][j] = static_cast<float>(X.R(int(i), int(j)));
      p[i] = static_cast<float>(X.p[int(i)]);
    }
  }
};

/// One lane of a node: how large it is, and where it stands in the frame of the test.
struct Box {
  const SurfaceTree::Node* node;
  const SurfaceTree::Stand* at;
  std::size_t lane;
};

/// Of two leaves, a bit 8 i + k for the feature i of the one and k of the other that may be a minimum.
using Matches = std::uint64_t;

/// The tests, for one kind of processor.
struct Kernels {
  /// A bit for each lane of a node that stands there whose cones face those of the box, and whose box
  /// overlaps the other along the axes of either when padded.
  std::uint32_t (*facing)(const Box& box, const SurfaceTree::Node& node, const SurfaceTree::Stand& at,
                          const Bounds& q) noexcept;
  /// The vertices of a leaf, their middle `off` from the other leaf's, with the features of the other leaf,
  /// whose box is told.
  Matches (*vertex_vertex)(const SurfaceTree::VertexLeaf& ones, const Three& off, const Box& box,
                           const SurfaceTree::VertexLeaf& others, const Bounds& q) noexcept;
  Matches (*vertex_edge)(const SurfaceTree::VertexLeaf& ones, const Three& off, const Box& box,
                         const SurfaceTree::EdgeLeaf& others, const Bounds& q) noexcept;
  Matches (*vertex_face)(const SurfaceTree::VertexLeaf& ones, const Three& off, const Box& box,
                         const SurfaceTree::FaceLeaf& others, const Bounds& q) noexcept;
  /// The edges of two leaves, each against the other's box first.
  Matches (*edge_edge)(const SurfaceTree::EdgeLeaf& ones, const Box& box_of_ones, const Three& off,
                       const SurfaceTree::EdgeLeaf& others, const Box& box_of_others,
                       const Bounds& q) noexcept;
  /// In the other tree's frame; leaves keep the middle they are told from.
  void (*turn_stand)(const SurfaceTree::Stand& at, const Frame& frame, SurfaceTree::Stand& turned) noexcept;
  void (*turn_vertices)(const SurfaceTree::VertexLeaf& leaf, const Frame& frame,
                        SurfaceTree::VertexLeaf& turned) noexcept;
  void (*turn_edges)(const SurfaceTree::EdgeLeaf& leaf, const Frame& frame,
                     SurfaceTree::EdgeLeaf& turned) noexcept;
};

/// Four lanes at a time, on any processor.
const Kernels& narrow_kernels() noexcept;
/// Eight at a time with AVX2; null where the program or the processor is without.
const Kernels* wide_kernels() noexcept;
/// The best there are.
inline const Kernels& kernels() noexcept {
  const Kernels* wide = wide_kernels();
  return wide ? *wide : narrow_kernels();
}

}  // namespace tactum::lanes
