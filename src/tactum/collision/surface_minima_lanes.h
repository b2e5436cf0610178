#pragma once
/// The quick half of surface_minima.h: which of eight boxes, or features, may have to do with one. Single
/// precision, eight lanes at once where the processor has AVX2, else twice four. Every lane is plain IEEE
/// arithmetic in one order, so the answers are the same bits on every build and processor; they err on the
/// safe side only, and what they let through is tested exactly.
///
///     leaf of A           box of B's leaf         leaf of B
///     eight features ──► which are near it? ──► each against eight: a bit for a pair that may be a minimum

#include <array>
#include <cstdint>

#include "tactum/geometry/surface_tree.h"

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

/// How far the other end of a minimum may be from a box or a feature, along its axes: a minimum is as long as
/// the reach along a direction in both cones, so within narrow ones it hardly leans to the side, and it never
/// starts behind the surface by more than the depth.
struct Pad {
  float side;          ///< along the first two axes [m]
  float above, below;  ///< before and behind the surface [m]
};

/// One lane of a node, in its own tree's frame or the other's.
struct Box {
  Three center;
  std::array<Three, 3> axis;
  Three half;
  float cone;
  Pad pad;
};

/// The features of a leaf in eight lanes, told from the middle of its box; lanes without a feature are far
/// away.
struct Vertices {
  Lanes3 point;
};
struct Edges {
  Lanes3 point, along;  ///< where it starts, and from there to its end
};
/// By planes: a point p is at the height  normal . p - level  and inside where  inward . p >= limit  for all
/// three sides.
struct Faces {
  Lanes3 normal;
  Lanes level;
  std::array<Lanes3, 3> inward;  ///< square to side and normal, as long as the side
  std::array<Lanes, 3> limit;    ///< a little outside
};

/// Of each of the eight features of a leaf, a bit for each of another's that it may be a minimum with.
using Matches = std::array<std::uint8_t, kLanes>;

/// The tests, for one kind of processor.
struct Kernels {
  /// A bit for each lane of a node whose cones face those of the box, and whose box overlaps the other along
  /// the axes of either when padded.
  std::uint32_t (*facing)(const Box& box, const SurfaceTree::Node& node, const Bounds& q) noexcept;
  /// A bit for each feature that, moved by `off`, overlaps the box along the box's own axes when padded.
  std::uint32_t (*vertices_near)(const Vertices& ones, const Three& off, const Box& box) noexcept;
  std::uint32_t (*edges_near)(const Edges& ones, const Three& off, const Box& box) noexcept;
  /// For each of the ones whose bit is set, moved by `off`: which of the many are near it, by place alone.
  void (*vertex_vertex)(const Vertices& ones, const Three& off, std::uint32_t set, const Vertices& many,
                        const Bounds& q, Matches& matches) noexcept;
  void (*vertex_edge)(const Vertices& ones, const Three& off, std::uint32_t set, const Edges& many,
                      const Bounds& q, Matches& matches) noexcept;
  void (*vertex_face)(const Vertices& ones, const Three& off, std::uint32_t set, const Faces& many,
                      const Bounds& q, Matches& matches) noexcept;
  void (*edge_edge)(const Edges& ones, const Three& off, std::uint32_t set, const Edges& many,
                    const Bounds& q, Matches& matches) noexcept;
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
