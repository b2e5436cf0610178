#pragma once
/// The quick half of surface_minima.h: which of eight boxes, or features, may form a minimum with one. Single
/// precision, eight lanes at once where the processor has AVX2, else twice four. Every lane is plain IEEE
/// arithmetic in one order, so the answers are the same bits on every build and processor; they err on the
/// safe side only, and pairs that they let through are tested exactly.
///
///     leaf of one        box of the other's leaf         leaf of the other
///     eight features ──► which are near it? ──► these against eight: a bit for a pair that may be a minimum
///
/// Everything is in the frame of the other tree, from its center. Nodes and leaves of the one are turned into
/// it eight lanes at a time. A tree stores only which features a leaf holds; their coordinates are gathered
/// in lanes when a leaf is first needed.

#include <array>
#include <cstdint>

#include "tactum/base/cpu_dispatch.h"
#include "tactum/geometry/surface_tree.h"
#include "tactum/math/pose.h"

namespace tactum::inline v0_1::lanes {

inline constexpr std::size_t kLanes = SurfaceTree::kLanes;
using Lanes = SurfaceTree::Lanes;
using Lanes3 = SurfaceTree::Lanes3;
using Corners = SurfaceTree::Corners;
using Three = std::array<float, 3>;

/// The input of every quick test, grown so that rounding loses nothing.
struct Bounds {
  float max_distance, depth, far;  ///< far: the larger of the two [m]
  float inflation;                 ///< of one cone [rad]
  float grown;                     ///< by which lengths are grown [m]
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

/// A gathered leaf: eight features of one kind, from the middle of the leaf's box. Lanes whose corner is
/// -1 hold no feature but numbers all the same.
struct VertexLeaf {
  Lanes3 point;  ///< [m]
  Corners corner;
};
struct EdgeLeaf {
  Lanes3 point, along;            ///< where it starts, and from there to its end [m]
  std::array<Lanes3, 2> falling;  ///< square to it into its two faces, at a rim twice into one, units [-]
  Corners corner;
};
/// By planes: a point p is at the height  normal . p - level  and inside where  inward . p >= limit  for all
/// three sides.
struct FaceLeaf {
  Lanes3 normal;                 ///< unit [-]
  Lanes level;                   ///< [m]
  std::array<Lanes3, 3> inward;  ///< square to side and normal, unit [-]
  std::array<Lanes, 3> limit;    ///< grown by the rounding error [m]
  Corners corner;
};
/// Points of eight features before they are rounded: along which axis, of which lane [m].
using Points = std::array<std::array<double, kLanes>, 3>;

/// Of two leaves, a bit 8 i + k for the feature i of the one and k of the other that may be a minimum.
using Matches = std::uint64_t;

/// The tests, for one kind of processor.
struct Kernels {
  /// A bit for each lane of a node that stands there whose cones face those of the box, and whose box
  /// overlaps the other along the axes of either when padded.
  std::uint32_t (*facing)(const Box& box, const SurfaceTree::Node& node, const SurfaceTree::Stand& at,
                          const Bounds& q) noexcept;
  /// A bit for each feature of a leaf, its middle `off` from that of a box, that is near the box.
  std::uint32_t (*vertices_near)(const VertexLeaf& ones, const Three& off, const Box& box,
                                 const Bounds& q) noexcept;
  std::uint32_t (*edges_near)(const EdgeLeaf& ones, const Three& off, const Box& box,
                              const Bounds& q) noexcept;
  /// Some features of a leaf, its middle `off` from the other leaf's, with the features of the other leaf.
  Matches (*vertex_vertex)(const VertexLeaf& ones, std::uint32_t some, const Three& off,
                           const VertexLeaf& others, const Bounds& q) noexcept;
  Matches (*vertex_edge)(const VertexLeaf& ones, std::uint32_t some, const Three& off, const EdgeLeaf& others,
                         const Bounds& q) noexcept;
  Matches (*vertex_face)(const VertexLeaf& ones, std::uint32_t some, const Three& off, const FaceLeaf& others,
                         const Bounds& q) noexcept;
  /// The same of edges, with some of the other leaf, from the side that has fewer.
  Matches (*edge_edge)(const EdgeLeaf& ones, std::uint32_t some, const Three& off, const EdgeLeaf& others,
                       std::uint32_t some_others, const Bounds& q) noexcept;
  /// Into the other tree's frame; leaves keep the middle they start from.
  void (*turn_stand)(const SurfaceTree::Stand& at, const Frame& frame, SurfaceTree::Stand& turned) noexcept;
  void (*turn_vertices)(const Frame& frame, VertexLeaf& leaf) noexcept;
  void (*turn_edges)(const Frame& frame, EdgeLeaf& leaf) noexcept;
  /// All of a leaf but the names of its features: from the ends of edges and the other corners of the faces
  /// beside them; from the corners of triangles, limits grown by that length.
  void (*lay_edges)(const std::array<Points, 4>& points, EdgeLeaf& leaf) noexcept;
  void (*lay_faces)(const std::array<Points, 3>& corners, float grown, FaceLeaf& leaf) noexcept;
};

/// Four lanes at a time on any processor, eight with AVX2.
CpuBuilds<Kernels> builds() noexcept;

}  // namespace tactum::inline v0_1::lanes
