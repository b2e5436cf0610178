#pragma once
/// The quick half of surface_minima.h: which of eight boxes, or features, may have to do with one. Four lanes
/// of single precision at a time, by the vector types that g++ and clang++ share; plain SSE where there is
/// nothing better. Every lane is plain IEEE arithmetic, so the answers are the same bits on every build; they
/// err on the safe side only, and what they let through is tested exactly.

#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

#include "tactum/geometry/surface_tree.h"

namespace tactum::lanes {

using Float4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));
using Three = std::array<float, 3>;
inline constexpr std::size_t kLanes = SurfaceTree::kLanes;

inline Float4 load(const float* from) noexcept {
  Float4 v;
  std::memcpy(&v, from, sizeof v);
  return v;
}
inline Float4 all(float x) noexcept { return Float4{x, x, x, x}; }
inline Float4 absolute(Float4 x) noexcept {
  return std::bit_cast<Float4>(std::bit_cast<Int4>(x) & 0x7fffffff);
}
inline Float4 smaller(Float4 x, Float4 y) noexcept { return x < y ? x : y; }
/// A bit a lane of a mask.
inline std::uint32_t bits(Int4 mask) noexcept {
#ifdef __SSE2__
  return static_cast<std::uint32_t>(_mm_movemask_ps(std::bit_cast<__m128>(mask)));
#else
  return std::uint32_t((mask[0] & 1) | (mask[1] & 2) | (mask[2] & 4) | (mask[3] & 8));
#endif
}

struct Vector4 {
  Float4 x, y, z;
};
inline Vector4 load(const SurfaceTree::Lanes3& v, std::size_t first) noexcept {
  return {load(&v[0][first]), load(&v[1][first]), load(&v[2][first])};
}
inline Vector4 all(const Three& v) noexcept { return {all(v[0]), all(v[1]), all(v[2])}; }
inline void store(const Vector4& v, SurfaceTree::Lanes3& to, std::size_t first) noexcept {
  std::memcpy(&to[0][first], &v.x, sizeof v.x);
  std::memcpy(&to[1][first], &v.y, sizeof v.y);
  std::memcpy(&to[2][first], &v.z, sizeof v.z);
}
inline Vector4 operator+(const Vector4& a, const Vector4& b) noexcept {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Vector4 operator-(const Vector4& a, const Vector4& b) noexcept {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Float4 dot(const Vector4& a, const Vector4& b) noexcept { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vector4 cross(const Vector4& a, const Vector4& b) noexcept {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/// No less than the length, at most 1.8 times it.
inline Float4 at_most(const Vector4& v) noexcept { return absolute(v.x) + absolute(v.y) + absolute(v.z); }

}  // namespace tactum::lanes
