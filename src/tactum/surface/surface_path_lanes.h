#pragma once
/// The quick half of surface_path.h: which of eight boxes, or triangles, may touch one box or one triangle
/// while B moves. Single precision, eight lanes at once where the processor has AVX2, else twice four, with
/// the same bits on every build and processor, as in surface_minima_lanes.h; what they let through is tested
/// in double precision.
///
/// Everything is in A's axes, from the center of A's mesh.

#include <array>
#include <cstdint>

#include "tactum/base/cpu_dispatch.h"
#include "tactum/geometry/surface_layout.h"

namespace tactum::inline v0_1::lanes {

/// Eight boxes of faces, at the start of the motion. Of B's boxes what their motion needs, of A's zeros.
struct EightBoxes {
  using Lanes = SurfaceLayout::Lanes;
  using Lanes3 = SurfaceLayout::Lanes3;
  std::array<Lanes3, 3> axis;  ///< up, along and across, units [-]
  Lanes3 half;                 ///< half the sides along these [m]
  Lanes3 center;               ///< [m]
  Lanes3 moved;                ///< the displacement of the center, as on a line [m]
  Lanes
      off_line;  ///< times the turn of a direction: how far a point may leave the center's line along it [m]
};

/// One of them.
struct OneBox {
  std::array<std::array<float, 3>, 3> axis;
  std::array<float, 3> half, center, moved;
  float off_line;
};

/// The turn of the motion [rad].
struct PathTurn {
  std::array<float, 3> w;
  float square;
};

/// Eight triangles: their corners at the start, and of B at the end, and their unit normals at the start.
/// Lanes without a triangle hold one of the others.
struct EightTriangles {
  std::array<SurfaceLayout::Lanes3, 6> corner;  ///< [m]
  SurfaceLayout::Lanes3 normal;                 ///< [-]
};

/// What a box may range, along its axes, from its center [m].
struct BoxRange {
  std::array<float, 3> low, high;
};

/// Between two parallel planes: level_low <= normal . x <= level_high.
struct Slab {
  std::array<float, 3> normal;
  float level_low, level_high;
};

/// The tests, for one kind of processor. Each returns a bit for every lane that is not surely apart.
struct PathKernels {
  /// Eight boxes and one, of which the eight move, or the one; by more than `grown` [m].
  std::uint32_t (*boxes)(const EightBoxes& eight, bool eight_move, const OneBox& one, const PathTurn& turn,
                         float grown) noexcept;
  /// Eight triangles, by so many of their corners, and the range of a box.
  std::uint32_t (*near_box)(const EightTriangles& eight, std::size_t corners, const OneBox& box,
                            const BoxRange& range) noexcept;
  /// Eight triangles, by so many of their corners, and a slab.
  std::uint32_t (*in_slab)(const EightTriangles& eight, std::size_t corners, const Slab& slab) noexcept;
};

/// Four lanes at a time on any processor, eight with AVX2.
CpuBuilds<PathKernels> path_builds() noexcept;

}  // namespace tactum::inline v0_1::lanes
