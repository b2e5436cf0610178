#pragma once
/// The tests of surface_path_lanes.h, written once for any number of lanes. surface_path_narrow.cpp and
/// surface_path_wide.cpp make functions of them, as surface_minima_kernels.h says.

#include "tactum/surface/surface_minima_kernels.h"
#include "tactum/surface/surface_path_lanes.h"

namespace tactum::inline v0_1::lanes {

template <std::size_t Width>
class PathKernelsOf {
 public:
  static constexpr PathKernels table() noexcept { return {boxes, near_box, in_slab}; }

 private:
  using W = Wide<Width>;
  using Float = typename W::Float;
  using Int = typename W::Int;
  using SomeLanes = SurfaceLayout::Lanes;

  static Float all(float x) noexcept { return W::all(x); }
  static Float load(const SomeLanes& from, std::size_t first) noexcept {
    Float v;
    std::memcpy(&v, &from[first], sizeof v);
    return v;
  }
  static Float absolute(Float x) noexcept { return std::bit_cast<Float>(std::bit_cast<Int>(x) & 0x7fffffff); }
  static Float larger(Float a, Float b) noexcept { return a > b ? a : b; }
  static Float smaller(Float a, Float b) noexcept { return a < b ? a : b; }

  struct Vector {
    Float x, y, z;
  };
  static Float dot(const Vector& a, const Vector& b) noexcept { return a.x * b.x + a.y * b.y + a.z * b.z; }
  static Vector load(const SurfaceLayout::Lanes3& v, std::size_t first) noexcept {
    return {load(v[0], first), load(v[1], first), load(v[2], first)};
  }
  static Vector all(const std::array<float, 3>& v) noexcept { return {all(v[0]), all(v[1]), all(v[2])}; }
  static Vector between(const Vector& to, const Vector& from) noexcept {
    return {to.x - from.x, to.y - from.y, to.z - from.z};
  }

  template <class Test>
  static std::uint32_t every_lane(const Test& test) noexcept {
    std::uint32_t found = 0;
    for (std::size_t first = 0; first < kLanes; first += Width) found |= W::bits(test(first)) << first;
    return found;
  }

  /// How the boxes of some lanes lie to each other and move.
  struct Approach {
    Vector off;      // from A's center to B's
    Vector moved;    // of B
    Vector w;        // turn
    Float square;    // of the turn
    Float off_line;  // of B
    Float grown;

    /// Whether the direction n keeps boxes apart whose extents along it add up to `extent`. The turn of n is
    /// |n x w|; its square is compared, so that no root is needed.
    Int apart(const Vector& n, Float extent) const noexcept {
      const Float height = dot(n, off);
      const Float opening = dot(n, moved);
      const Float toward = height >= all(0.0F) ? -opening : opening;
      const Float room = absolute(height) - extent - larger(toward, all(0.0F)) - grown;
      const Float along_w = dot(n, w);
      const Float turn_sq = larger(square - along_w * along_w, all(0.0F));
      return (room > all(0.0F)) & (room * room > turn_sq * off_line * off_line);
    }
  };

  static std::uint32_t boxes(const EightBoxes& eight, bool eight_move, const OneBox& one,
                             const PathTurn& turn, float grown) noexcept {
    return every_lane([&](std::size_t first) {
      const Vector of_eight = load(eight.center, first);
      const Vector of_one = all(one.center);
      const Approach approach = {eight_move ? between(of_eight, of_one) : between(of_one, of_eight),
                                 eight_move ? load(eight.moved, first) : all(one.moved),
                                 all(turn.w),
                                 all(turn.square),
                                 eight_move ? load(eight.off_line, first) : all(one.off_line),
                                 all(grown)};
      const Vector axis[3] = {load(eight.axis[0], first), load(eight.axis[1], first),
                              load(eight.axis[2], first)};
      const Vector own[3] = {all(one.axis[0]), all(one.axis[1]), all(one.axis[2])};
      const Float half[3] = {load(eight.half[0], first), load(eight.half[1], first),
                             load(eight.half[2], first)};
      Int apart = {};
      Float cosine[3][3];
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t k = 0; k < 3; ++k) cosine[i][k] = absolute(dot(own[i], axis[k]));
        apart |= approach.apart(
            own[i], one.half[i] + cosine[i][0] * half[0] + cosine[i][1] * half[1] + cosine[i][2] * half[2]);
      }
      for (std::size_t k = 0; k < 3; ++k)
        apart |= approach.apart(axis[k], half[k] + cosine[0][k] * one.half[0] + cosine[1][k] * one.half[1] +
                                             cosine[2][k] * one.half[2]);
      return ~apart;
    });
  }

  struct Range {
    Float low, high;
  };
  /// The least and the greatest height of the first corners along n.
  static Range heights(const EightTriangles& eight, std::size_t corners, std::size_t first,
                       const Vector& n) noexcept {
    const Float start = dot(n, load(eight.corner[0], first));
    Range range = {start, start};
    for (std::size_t c = 1; c < corners; ++c) {
      const Float height = dot(n, load(eight.corner[c], first));
      range = {smaller(range.low, height), larger(range.high, height)};
    }
    return range;
  }

  static std::uint32_t near_box(const EightTriangles& eight, std::size_t corners, const OneBox& box,
                                const BoxRange& room) noexcept {
    return every_lane([&](std::size_t first) {
      Int near = ~Int{};
      for (std::size_t i = 0; i < 3; ++i) {
        const Vector n = all(box.axis[i]);
        const Float center = dot(n, all(box.center));
        const Range range = heights(eight, corners, first, n);
        near &= (range.low - center <= all(room.high[i])) & (range.high - center >= all(room.low[i]));
      }
      return near;
    });
  }

  static std::uint32_t in_slab(const EightTriangles& eight, std::size_t corners, const Slab& slab) noexcept {
    return every_lane([&](std::size_t first) {
      const Range range = heights(eight, corners, first, all(slab.normal));
      return (range.low <= all(slab.level_high)) & (range.high >= all(slab.level_low));
    });
  }
};

}  // namespace tactum::inline v0_1::lanes
