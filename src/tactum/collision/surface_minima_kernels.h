#pragma once
/// The tests of surface_minima_lanes.h, written once for any number of lanes. surface_minima_narrow.cpp and
/// surface_minima_wide.cpp make functions of them; the second is compiled for AVX2, so nothing here calls a
/// function that other files may hold a copy of: of equal copies the linker keeps one, for all processors.

#if defined(__AVX2__)
#include <immintrin.h>
#elif defined(__SSE2__)
#include <emmintrin.h>
#endif

#include <bit>
#include <cstring>

#include "tactum/base/tolerances.h"
#include "tactum/collision/surface_minima_lanes.h"

namespace tactum::lanes {

/// Vectors of so many numbers, as g++ and clang++ share them.
template <std::size_t Width>
struct Wide;

template <>
struct Wide<4> {
  using Float = float __attribute__((vector_size(16)));
  using Int = std::int32_t __attribute__((vector_size(16)));
  static Float all(float x) noexcept { return Float{x, x, x, x}; }
  /// A bit a lane of a mask.
  static std::uint32_t bits(Int mask) noexcept {
#ifdef __SSE2__
    return static_cast<std::uint32_t>(_mm_movemask_ps(std::bit_cast<__m128>(mask)));
#else
    return std::uint32_t((mask[0] & 1) | (mask[1] & 2) | (mask[2] & 4) | (mask[3] & 8));
#endif
  }
};

#ifdef __AVX2__
template <>
struct Wide<8> {
  using Float = float __attribute__((vector_size(32)));
  using Int = std::int32_t __attribute__((vector_size(32)));
  static Float all(float x) noexcept { return Float{x, x, x, x, x, x, x, x}; }
  static std::uint32_t bits(Int mask) noexcept {
    return static_cast<std::uint32_t>(_mm256_movemask_ps(std::bit_cast<__m256>(mask)));
  }
};
#endif

template <std::size_t Width>
class KernelsOf {
 public:
  static constexpr Kernels table() noexcept {
    return {facing,
            vertices_near,
            edges_near,
            match<Vertices, Vertices>,
            match<Vertices, Edges>,
            match<Vertices, Faces>,
            match<Edges, Edges>};
  }

 private:
  using W = Wide<Width>;
  using Float = typename W::Float;
  using Int = typename W::Int;

  static constexpr float kRightAngle = 1.57F;  // a little less

  struct Vector {
    Float x, y, z;
    friend Vector operator+(const Vector& a, const Vector& b) noexcept {
      return {a.x + b.x, a.y + b.y, a.z + b.z};
    }
    friend Vector operator-(const Vector& a, const Vector& b) noexcept {
      return {a.x - b.x, a.y - b.y, a.z - b.z};
    }
  };

  static Float load(const Lanes& from, std::size_t first) noexcept {
    Float v;
    std::memcpy(&v, &from[first], sizeof v);
    return v;
  }
  static Vector load(const Lanes3& v, std::size_t first) noexcept {
    return {load(v[0], first), load(v[1], first), load(v[2], first)};
  }
  static Float all(float x) noexcept { return W::all(x); }
  static Vector all(const Three& v) noexcept { return {all(v[0]), all(v[1]), all(v[2])}; }
  static Float absolute(Float x) noexcept { return std::bit_cast<Float>(std::bit_cast<Int>(x) & 0x7fffffff); }
  static Float dot(const Vector& a, const Vector& b) noexcept { return a.x * b.x + a.y * b.y + a.z * b.z; }
  static Vector cross(const Vector& a, const Vector& b) noexcept {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  }
  /// No less than the length, at most 1.8 times it.
  static Float at_most(const Vector& v) noexcept { return absolute(v.x) + absolute(v.y) + absolute(v.z); }
  static std::uint32_t bits(Int mask) noexcept { return W::bits(mask); }

  /// A test of some of the lanes, as often as there are more.
  template <class Test>
  static std::uint32_t every_lane(const Test& test) noexcept {
    std::uint32_t found = 0;
    for (std::size_t first = 0; first < kLanes; first += Width) found |= test(first) << first;
    return found;
  }

  // ---- boxes ----

  static std::uint32_t facing(const Box& box, const SurfaceTree::Node& node, const Bounds& q) noexcept {
    return every_lane([&](std::size_t first) { return facing_from(box, node, first, q); });
  }

  /// Some of the lanes, from `first` on. The most telling axes come first: mostly no lane is left before the
  /// others.
  static std::uint32_t facing_from(const Box& box, const SurfaceTree::Node& node, std::size_t first,
                                   const Bounds& q) noexcept {
    const std::array<Vector, 3> own = {all(box.axis[0]), all(box.axis[1]), all(box.axis[2])};
    const Vector up = load(node.up, first);
    const Float cone = load(node.cone, first);
    const Float opposite = dot(own[2], up);
    const Float sum = cone + (box.cone + 2.0F * q.slack);
    std::int32_t child[Width];
    std::memcpy(child, &node.child[first], sizeof child);
    Int fine = std::bit_cast<Int>(child) != 0;
    fine &= 2.0F + 2.0F * opposite <= sum * sum + float(tolerances::kSingle);
    if (bits(fine) == 0) return 0;

    // How far the box reaches along an axis of the lanes, and the lanes along one of the box.
    const auto box_reach = [&](Float x, Float y, Float z) {
      return absolute(x) * box.half[0] + absolute(y) * box.half[1] + absolute(z) * box.half[2];
    };
    const Vector half = load(node.half, first);
    const auto lane_reach = [&](Float x, Float y, Float z) {
      return absolute(x) * half.x + absolute(y) * half.y + absolute(z) * half.z;
    };
    const Vector off = all(box.center) - load(node.center, first);
    const Float width = cone + q.slack;
    const Int leans = width < kRightAngle;
    const Float up0 = dot(own[0], up);
    const Float up1 = dot(own[1], up);
    const Float height = dot(off, up);
    const Float thick = box_reach(up0, up1, opposite) + half.z;
    fine &= (height <= thick + (leans ? all(q.reach) : all(q.far))) &
            (-height <= thick + (leans ? all(q.depth) : all(q.far)));
    if (bits(fine) == 0) return 0;

    const Vector along = load(node.along, first);
    const Vector across = cross(up, along);
    const Float own2_along = dot(own[2], along);
    const Float own2_across = dot(own[2], across);
    const Float depth = dot(off, own[2]);
    const Float deep = lane_reach(own2_along, own2_across, opposite) + box.half[2];
    fine &= (-depth <= deep + box.pad.above) & (depth <= deep + box.pad.below);
    if (bits(fine) == 0) return 0;

    const Float side = (width < 1.0F ? width : all(1.0F)) * q.far;
    const Float own0_along = dot(own[0], along);
    const Float own1_along = dot(own[1], along);
    const Float own0_across = dot(own[0], across);
    const Float own1_across = dot(own[1], across);
    fine &= (absolute(dot(off, along)) <= box_reach(own0_along, own1_along, own2_along) + half.x + side) &
            (absolute(dot(off, across)) <= box_reach(own0_across, own1_across, own2_across) + half.y + side);
    fine &= (absolute(dot(off, own[0])) <=
             lane_reach(own0_along, own0_across, up0) + (box.half[0] + box.pad.side)) &
            (absolute(dot(off, own[1])) <=
             lane_reach(own1_along, own1_across, up1) + (box.half[1] + box.pad.side));
    return bits(fine);
  }

  // ---- features near a box ----

  static std::uint32_t vertices_near(const Vertices& ones, const Three& off, const Box& box) noexcept {
    return every_lane([&](std::size_t first) {
      const Vector r = load(ones.point, first) + all(off);
      const Float height = dot(r, all(box.axis[2]));
      return bits((absolute(dot(r, all(box.axis[0]))) <= box.half[0] + box.pad.side) &
                  (absolute(dot(r, all(box.axis[1]))) <= box.half[1] + box.pad.side) &
                  (height <= box.half[2] + box.pad.above) & (-height <= box.half[2] + box.pad.below));
    });
  }

  static std::uint32_t edges_near(const Edges& ones, const Three& off, const Box& box) noexcept {
    return every_lane([&](std::size_t first) {
      const Vector along = load(ones.along, first);
      const Vector half = {0.5F * along.x, 0.5F * along.y, 0.5F * along.z};
      const Vector middle = load(ones.point, first) + all(off) + half;
      const auto share = [&](std::size_t i) { return absolute(dot(half, all(box.axis[i]))) + box.half[i]; };
      const Float height = dot(middle, all(box.axis[2]));
      const Float thick = share(2);
      return bits((absolute(dot(middle, all(box.axis[0]))) <= share(0) + box.pad.side) &
                  (absolute(dot(middle, all(box.axis[1]))) <= share(1) + box.pad.side) &
                  (height <= thick + box.pad.above) & (-height <= thick + box.pad.below));
    });
  }

  // ---- features near each other ----

  template <class One, class Many>
  static void match(const One& ones, const Three& off, std::uint32_t set, const Many& many, const Bounds& q,
                    Matches& matches) noexcept {
    for (std::size_t i = 0; i < kLanes; ++i) {
      if ((set >> i & 1u) == 0) continue;
      const Three p = {ones.point[0][i] + off[0], ones.point[1][i] + off[1], ones.point[2][i] + off[2]};
      matches[i] = static_cast<std::uint8_t>(every_lane([&](std::size_t first) {
        if constexpr (requires { ones.along; }) {
          return near_edge(all(p), all(Three{ones.along[0][i], ones.along[1][i], ones.along[2][i]}), many,
                           first, q);
        } else {
          return near_vertex(all(p), many, first, q);
        }
      }));
    }
  }

  static std::uint32_t near_vertex(const Vector& p, const Vertices& many, std::size_t first,
                                   const Bounds& q) noexcept {
    const Vector r = p - load(many.point, first);
    return bits(dot(r, r) <= all(q.reach * q.reach));
  }

  static std::uint32_t near_vertex(const Vector& p, const Edges& many, std::size_t first,
                                   const Bounds& q) noexcept {
    const Vector w = load(many.along, first);
    const Vector r = p - load(many.point, first);
    const Float at = dot(r, w);
    const Float pad = q.grown * at_most(w);
    return bits((at >= -pad) & (at <= dot(w, w) + pad) & near_line(cross(r, w), w, all(q.reach)));
  }

  static std::uint32_t near_vertex(const Vector& p, const Faces& many, std::size_t first,
                                   const Bounds& q) noexcept {
    const Float height = dot(p, load(many.normal, first)) - load(many.level, first);
    Int fine = (height <= q.reach) & (height >= -q.depth);
    for (std::size_t k = 0; k < 3; ++k)
      fine &= dot(p, load(many.inward[k], first)) >= load(many.limit[k], first);
    return bits(fine);
  }

  static std::uint32_t near_edge(const Vector& p, const Vector& u, const Edges& many, std::size_t first,
                                 const Bounds& q) noexcept {
    // Below this sine single precision cannot tell where lines come nearest; their distance alone is asked.
    const float slack = 1.01F * q.slack;
    const float parallel = slack > 0.01F ? slack : 0.01F;
    const Vector w = load(many.along, first);
    const Vector r = load(many.point, first) - p;
    const Vector c = cross(u, w);
    const Float sine_sq = dot(c, c);
    const Float height = dot(r, c);
    const Vector from_u = cross(r, u);
    const Int together = (sine_sq <= parallel * parallel * dot(u, u) * dot(w, w)) &
                         near_line(from_u, u, q.far + parallel * at_most(w));
    const Int level = height * height <= q.far * q.far * sine_sq;
    if (bits(level) == 0) return bits(together);
    const Float on_u = dot(cross(r, w), c);
    const Float on_w = dot(from_u, c);
    const Float length = q.grown * at_most(c);
    const Float pad_u = length * at_most(w);
    const Float pad_w = length * at_most(u);
    return bits(together | (level & (on_u >= -pad_u) & (on_u <= sine_sq + pad_u) & (on_w >= -pad_w) &
                            (on_w <= sine_sq + pad_w)));
  }

  /// Whether points are within `reach` of lines along w; `off`: the cross product of the way from a line's
  /// start to the point with w.
  static Int near_line(const Vector& off, const Vector& w, Float reach) noexcept {
    return dot(off, off) <= reach * reach * dot(w, w);
  }
};

}  // namespace tactum::lanes
