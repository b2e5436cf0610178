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
#include "tactum/surface/surface_minima_lanes.h"

namespace tactum::inline v0_1::lanes {

/// Vectors of so many numbers, as g++ and clang++ share them; of doubles half as many.
template <std::size_t Width>
struct Wide;

template <>
struct Wide<4> {
  using Float = float __attribute__((vector_size(16)));
  using Int = std::int32_t __attribute__((vector_size(16)));
  using Double = double __attribute__((vector_size(16)));
  using HalfFloat = float __attribute__((vector_size(8)));
  static Float all(float x) noexcept { return Float{x, x, x, x}; }
  static Double root(Double x) noexcept {
#ifdef __SSE2__
    return std::bit_cast<Double>(_mm_sqrt_pd(std::bit_cast<__m128d>(x)));
#else
    return Double{__builtin_sqrt(x[0]), __builtin_sqrt(x[1])};
#endif
  }
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
  using Double = double __attribute__((vector_size(32)));
  using HalfFloat = float __attribute__((vector_size(16)));
  static Float all(float x) noexcept { return Float{x, x, x, x, x, x, x, x}; }
  static Double root(Double x) noexcept {
    return std::bit_cast<Double>(_mm256_sqrt_pd(std::bit_cast<__m256d>(x)));
  }
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
            near,
            near,
            of_vertices<VertexLeaf>,
            of_vertices<EdgeLeaf>,
            of_vertices<FaceLeaf>,
            edge_edge,
            turn_stand,
            turn_vertices,
            turn_edges,
            lay_edges,
            lay_faces};
  }

 private:
  using Node = SurfaceTree::Node;
  using Stand = SurfaceTree::Stand;
  using W = Wide<Width>;
  using Float = typename W::Float;
  using Int = typename W::Int;
  using Double = typename W::Double;

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
  static void store(Float v, Lanes& to, std::size_t first) noexcept { std::memcpy(&to[first], &v, sizeof v); }
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

  static Three lane_of(const Lanes3& v, std::size_t lane) noexcept {
    return {v[0][lane], v[1][lane], v[2][lane]};
  }
  static Vector spread(const Lanes3& v, std::size_t lane) noexcept {
    return {all(v[0][lane]), all(v[1][lane]), all(v[2][lane])};
  }

  /// How far the other end of a minimum may be from a box or a feature, along its axes: a minimum is as long
  /// as the largest distance along a direction in both cones, so within narrow ones it hardly leans to the
  /// side, and it never starts behind the surface by more than the depth.
  struct Pad {
    float side;          ///< along the first two axes [m]
    float above, below;  ///< before and behind the surface [m]
  };
  static Pad pad_of(float cone, const Bounds& q) noexcept {
    const float width = cone + q.inflation;
    const bool leans = width < kRightAngle;
    return {(width < 1.0F ? width : 1.0F) * q.far, leans ? q.max_distance : q.far, leans ? q.depth : q.far};
  }

  // ---- boxes ----

  static std::uint32_t facing(const Box& box, const Node& node, const Stand& at, const Bounds& q) noexcept {
    return every_lane([&](std::size_t first) { return facing_from(box, node, at, first, q); });
  }

  /// For some of the lanes, from `first` on. The axes that exclude most come first: often no lane is left
  /// before the others.
  static std::uint32_t facing_from(const Box& box, const Node& node, const Stand& at, std::size_t first,
                                   const Bounds& q) noexcept {
    const float box_cone = box.node->cone[box.lane];
    const Three box_half = lane_of(box.node->half, box.lane);
    const Pad box_pad = pad_of(box_cone, q);
    const Vector own_up = spread(box.at->up, box.lane);
    const Vector own_along = spread(box.at->along, box.lane);
    const Vector own_across = spread(box.at->across, box.lane);
    const Vector up = load(at.up, first);
    const Float cone = load(node.cone, first);
    const Float opposite = dot(own_up, up);
    const Float sum = cone + (box_cone + 2.0F * q.inflation);
    Int child;
    std::memcpy(&child, &node.child[first], sizeof child);
    Int fine = (child != 0) & (2.0F + 2.0F * opposite <= sum * sum + float(tolerances::kSingle));

    // The extent of the box along an axis of the lanes, and of the lanes along one of the box.
    const auto box_extent = [&](Float x, Float y, Float z) {
      return absolute(x) * box_half[0] + absolute(y) * box_half[1] + absolute(z) * box_half[2];
    };
    const Vector half = load(node.half, first);
    const auto lane_extent = [&](Float x, Float y, Float z) {
      return absolute(x) * half.x + absolute(y) * half.y + absolute(z) * half.z;
    };
    const Vector off = spread(box.at->center, box.lane) - load(at.center, first);
    const Float width = cone + q.inflation;
    const Int leans = width < kRightAngle;
    const Float along_up = dot(own_along, up);
    const Float across_up = dot(own_across, up);
    const Float height = dot(off, up);
    const Float thick = box_extent(along_up, across_up, opposite) + half.z;
    fine &= (height <= thick + (leans ? all(q.max_distance) : all(q.far))) &
            (-height <= thick + (leans ? all(q.depth) : all(q.far)));

    const Vector along = load(at.along, first);
    const Vector across = load(at.across, first);
    const Float up_along = dot(own_up, along);
    const Float up_across = dot(own_up, across);
    const Float depth = dot(off, own_up);
    const Float deep = lane_extent(up_along, up_across, opposite) + box_half[2];
    fine &= (-depth <= deep + box_pad.above) & (depth <= deep + box_pad.below);
    if (bits(fine) == 0) return 0;

    const Float side = (width < 1.0F ? width : all(1.0F)) * q.far;
    const Float along_along = dot(own_along, along);
    const Float across_along = dot(own_across, along);
    const Float along_across = dot(own_along, across);
    const Float across_across = dot(own_across, across);
    fine &=
        (absolute(dot(off, along)) <= box_extent(along_along, across_along, up_along) + half.x + side) &
        (absolute(dot(off, across)) <= box_extent(along_across, across_across, up_across) + half.y + side);
    fine &= (absolute(dot(off, own_along)) <=
             lane_extent(along_along, along_across, along_up) + (box_half[0] + box_pad.side)) &
            (absolute(dot(off, own_across)) <=
             lane_extent(across_along, across_across, across_up) + (box_half[1] + box_pad.side));
    return bits(fine);
  }

  // ---- features near a box ----

  /// Lanes with a feature.
  static Int used(const SurfaceTree::Corners& corner, std::size_t first) noexcept {
    Int c;
    std::memcpy(&c, &corner[first], sizeof c);
    return c >= 0;
  }

  static std::uint32_t near(const VertexLeaf& ones, const Three& off, const Box& box,
                            const Bounds& q) noexcept {
    const Pad pad = pad_of(box.node->cone[box.lane], q);
    const Three half = lane_of(box.node->half, box.lane);
    return every_lane([&](std::size_t first) {
      const Vector r = load(ones.point, first) + all(off);
      const Float height = dot(r, spread(box.at->up, box.lane));
      return bits(used(ones.corner, first) &
                  (absolute(dot(r, spread(box.at->along, box.lane))) <= half[0] + pad.side) &
                  (absolute(dot(r, spread(box.at->across, box.lane))) <= half[1] + pad.side) &
                  (height <= half[2] + pad.above) & (-height <= half[2] + pad.below));
    });
  }

  static std::uint32_t near(const EdgeLeaf& ones, const Three& off, const Box& box,
                            const Bounds& q) noexcept {
    const Pad pad = pad_of(box.node->cone[box.lane], q);
    const Three half = lane_of(box.node->half, box.lane);
    return every_lane([&](std::size_t first) {
      const Vector along = load(ones.along, first);
      const Vector to_end = {0.5F * along.x, 0.5F * along.y, 0.5F * along.z};
      const Vector middle = load(ones.point, first) + all(off) + to_end;
      const auto fits = [&](const Lanes3& axes, float room) {
        const Vector axis = spread(axes, box.lane);
        return absolute(dot(middle, axis)) <= absolute(dot(to_end, axis)) + room;
      };
      const Vector up = spread(box.at->up, box.lane);
      const Float height = dot(middle, up);
      const Float thick = absolute(dot(to_end, up)) + half[2];
      return bits(used(ones.corner, first) & fits(box.at->along, half[0] + pad.side) &
                  fits(box.at->across, half[1] + pad.side) & (height <= thick + pad.above) &
                  (-height <= thick + pad.below));
    });
  }

  // ---- features near each other ----

  template <class Leaf>
  static Matches of_vertices(const VertexLeaf& ones, std::uint32_t some, const Three& off, const Leaf& others,
                             const Bounds& q) noexcept {
    Matches matches = 0;
    for (; some != 0; some &= some - 1) {
      const auto i = std::size_t(std::countr_zero(some));
      const Vector p = {all(ones.point[0][i] + off[0]), all(ones.point[1][i] + off[1]),
                        all(ones.point[2][i] + off[2])};
      const std::uint32_t found = every_lane([&](std::size_t first) {
        return bits(used(others.corner, first) & near_vertex(p, others, first, q));
      });
      matches |= Matches(found) << (kLanes * i);
    }
    return matches;
  }

  static Matches edge_edge(const EdgeLeaf& ones, std::uint32_t some, const Three& off, const EdgeLeaf& others,
                           std::uint32_t some_others, const Bounds& q) noexcept {
    Matches matches = 0;
    if (std::popcount(some) <= std::popcount(some_others)) {
      for (std::uint32_t left = some; left != 0; left &= left - 1) {
        const auto i = std::size_t(std::countr_zero(left));
        matches |= Matches(near_one(ones, i, off, others, q) & some_others) << (kLanes * i);
      }
      return matches;
    }
    const Three back = {-off[0], -off[1], -off[2]};
    for (std::uint32_t left = some_others; left != 0; left &= left - 1) {
      const auto i = std::size_t(std::countr_zero(left));
      for (std::uint32_t found = near_one(others, i, back, ones, q) & some; found != 0; found &= found - 1)
        matches |= Matches(1) << (kLanes * std::size_t(std::countr_zero(found)) + i);
    }
    return matches;
  }

  static std::uint32_t near_one(const EdgeLeaf& ones, std::size_t i, const Three& off, const EdgeLeaf& many,
                                const Bounds& q) noexcept {
    const Edge one = {
        {all(ones.point[0][i] + off[0]), all(ones.point[1][i] + off[1]), all(ones.point[2][i] + off[2])},
        spread(ones.along, i),
        {spread(ones.falling[0], i), spread(ones.falling[1], i)}};
    return every_lane([&](std::size_t first) {
      return near_edge(one,
                       {load(many.point, first),
                        load(many.along, first),
                        {load(many.falling[0], first), load(many.falling[1], first)}},
                       q);
    });
  }

  static Int near_vertex(const Vector& p, const VertexLeaf& many, std::size_t first,
                         const Bounds& q) noexcept {
    const Vector r = p - load(many.point, first);
    return dot(r, r) <= all(q.max_distance * q.max_distance);
  }

  static Int near_vertex(const Vector& p, const EdgeLeaf& many, std::size_t first, const Bounds& q) noexcept {
    const Vector w = load(many.along, first);
    const Vector r = p - load(many.point, first);
    const Float at = dot(r, w);
    const Float pad = q.grown * at_most(w);
    const Vector off = cross(r, w);
    const Int fine = (at >= -pad) & (at <= dot(w, w) + pad) & near_line(off, w, all(q.max_distance));
    if (bits(fine) == 0) return fine;
    // Both faces fall away from the vector to the point.
    const Float length_sq = dot(w, w);
    const Float room = lean(q) * lean(q) * dot(off, off);
    const auto falls = [&](const Lanes3& falling) {
      const Float up = dot(load(falling, first), r) - q.grown;
      return (up <= 0.0F) | (up * up * length_sq <= room);
    };
    return fine & falls(many.falling[0]) & falls(many.falling[1]);
  }

  /// How far a face may lean up towards a direction of its edge's cone [rad]: the rounding of single
  /// precision is added to the inflation.
  static float lean(const Bounds& q) noexcept { return q.inflation + 1e-4F; }

  static Int near_vertex(const Vector& p, const FaceLeaf& many, std::size_t first, const Bounds& q) noexcept {
    const Float height = dot(p, load(many.normal, first)) - load(many.level, first);
    Int fine = (height <= q.max_distance) & (height >= -q.depth);
    for (std::size_t k = 0; k < 3; ++k)
      fine &= dot(p, load(many.inward[k], first)) >= load(many.limit[k], first);
    return fine;
  }

  struct Edge {
    Vector point, along;
    std::array<Vector, 2> falling;
  };

  static std::uint32_t near_edge(const Edge& one, const Edge& other, const Bounds& q) noexcept {
    // Below this sine single precision cannot tell where lines come nearest; only their distance is tested.
    const float inflation = 1.01F * q.inflation;
    const float parallel = inflation > 0.01F ? inflation : 0.01F;
    const Vector& u = one.along;
    const Vector& w = other.along;
    const Vector r = other.point - one.point;
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
    const Int cross_there =
        level & (on_u >= -pad_u) & (on_u <= sine_sq + pad_u) & (on_w >= -pad_w) & (on_w <= sine_sq + pad_w);
    if (bits(cross_there) == 0) return bits(together);
    // All four faces fall away from c, towards the other edge, or all from -c.
    const Float room = lean(q) * lean(q) * sine_sq;
    const auto fall = [&](const Edge& edge, const Vector& n) {
      const Float x = dot(edge.falling[0], n);
      const Float y = dot(edge.falling[1], n);
      return ((x <= 0.0F) | (x * x <= room)) & ((y <= 0.0F) | (y * y <= room));
    };
    const Vector back = {-c.x, -c.y, -c.z};
    const Int faces = (fall(one, c) & fall(other, back)) | (fall(one, back) & fall(other, c));
    return bits(together | (cross_there & faces));
  }

  /// Whether points are within `max_distance` of lines along w; `off`: the cross product of the vector from a
  /// line's start to the point with w.
  static Int near_line(const Vector& off, const Vector& w, Float max_distance) noexcept {
    return dot(off, off) <= max_distance * max_distance * dot(w, w);
  }

  // ---- the other tree's frame ----

  static void turn(const Lanes3& from, const Frame& frame, Lanes3& to, std::size_t first) noexcept {
    const Vector v = load(from, first);
    for (std::size_t k = 0; k < 3; ++k) store(dot(all(frame.R[k]), v), to[k], first);
  }
  static void turn_stand(const Stand& at, const Frame& frame, Stand& turned) noexcept {
    for (std::size_t first = 0; first < kLanes; first += Width) {
      turn(at.up, frame, turned.up, first);
      turn(at.along, frame, turned.along, first);
      turn(at.across, frame, turned.across, first);
      const Vector c = load(at.center, first);
      for (std::size_t k = 0; k < 3; ++k)
        store(dot(all(frame.R[k]), c) + all(frame.p[k]), turned.center[k], first);
    }
  }
  static void turn_vertices(const Frame& frame, VertexLeaf& leaf) noexcept {
    for (std::size_t first = 0; first < kLanes; first += Width) turn(leaf.point, frame, leaf.point, first);
  }
  static void turn_edges(const Frame& frame, EdgeLeaf& leaf) noexcept {
    for (std::size_t first = 0; first < kLanes; first += Width) {
      turn(leaf.point, frame, leaf.point, first);
      turn(leaf.along, frame, leaf.along, first);
      for (Lanes3& falling : leaf.falling) turn(falling, frame, falling, first);
    }
  }

  // ---- leaves, in double precision: single precision would lose the direction of a sliver ----

  struct DoubleVector {
    Double x, y, z;
    friend DoubleVector operator-(const DoubleVector& a, const DoubleVector& b) noexcept {
      return {a.x - b.x, a.y - b.y, a.z - b.z};
    }
  };
  static Double dot(const DoubleVector& a, const DoubleVector& b) noexcept {
    return a.x * b.x + a.y * b.y + a.z * b.z;
  }
  static DoubleVector cross(const DoubleVector& a, const DoubleVector& b) noexcept {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  }
  static void store(Double v, Lanes& to, std::size_t first) noexcept {
    const auto rounded = __builtin_convertvector(v, typename W::HalfFloat);
    std::memcpy(&to[first], &rounded, sizeof rounded);
  }
  static void store(const DoubleVector& v, Lanes3& to, std::size_t first) noexcept {
    store(v.x, to[0], first);
    store(v.y, to[1], first);
    store(v.z, to[2], first);
  }

  static DoubleVector load(const Points& from, std::size_t first) noexcept {
    DoubleVector v;
    std::memcpy(&v.x, &from[0][first], sizeof v.x);
    std::memcpy(&v.y, &from[1][first], sizeof v.y);
    std::memcpy(&v.z, &from[2][first], sizeof v.z);
    return v;
  }
  static DoubleVector times(const Double& scale, const DoubleVector& v) noexcept {
    return {scale * v.x, scale * v.y, scale * v.z};
  }
  static DoubleVector unit(const DoubleVector& v) noexcept { return times(1.0 / W::root(dot(v, v)), v); }

  static void lay_edges(const std::array<Points, 4>& points, EdgeLeaf& leaf) noexcept {
    for (std::size_t first = 0; first < kLanes; first += Width / 2) {
      const DoubleVector start = load(points[0], first);
      const DoubleVector along = load(points[1], first) - start;
      const Double length_sq = dot(along, along);
      store(start, leaf.point, first);
      store(along, leaf.along, first);
      for (std::size_t k = 0; k < 2; ++k) {
        const DoubleVector e = load(points[2 + k], first) - start;
        store(unit(e - times(dot(e, along) / length_sq, along)), leaf.falling[k], first);
      }
    }
  }

  static void lay_faces(const std::array<Points, 3>& corners, float grown, FaceLeaf& leaf) noexcept {
    for (std::size_t first = 0; first < kLanes; first += Width / 2) {
      const std::array<DoubleVector, 3> p = {load(corners[0], first), load(corners[1], first),
                                             load(corners[2], first)};
      const DoubleVector normal = unit(cross(p[1] - p[0], p[2] - p[0]));
      store(normal, leaf.normal, first);
      store(dot(normal, p[0]), leaf.level, first);
      for (std::size_t k = 0; k < 3; ++k) {
        const DoubleVector inward = unit(cross(normal, p[(k + 1) % 3] - p[k]));
        store(inward, leaf.inward[k], first);
        store(dot(inward, p[k]) - 2.0 * double(grown), leaf.limit[k], first);
      }
    }
  }
};

}  // namespace tactum::inline v0_1::lanes
