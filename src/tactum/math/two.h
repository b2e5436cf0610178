#pragma once
/// Two numbers side by side, in one register where the processor has such: plain IEEE arithmetic on each, the
/// same bits as alone.

#include <bit>
#include <cstdint>
#include <cstring>

#include "tactum/math/types.h"

namespace tactum::inline v0_1 {

using Two = double __attribute__((vector_size(16)));

inline Two both(double x) noexcept { return Two{x, x}; }
inline Two swapped(Two x) noexcept { return Two{x[1], x[0]}; }
inline Two larger(Two a, Two b) noexcept { return a > b ? a : b; }
inline Two magnitude(Two x) noexcept {
  using Bits = std::int64_t __attribute__((vector_size(16)));
  constexpr std::int64_t kAllButSign = 0x7fff'ffff'ffff'ffff;
  return std::bit_cast<Two>(std::bit_cast<Bits>(x) & Bits{kAllButSign, kAllButSign});
}

/// Read and written in one access: a wide read of what was just written in two parts waits for both.
inline Two two(const Vec2& x) noexcept {
  Two pair;
  std::memcpy(&pair, x.data(), sizeof pair);
  return pair;
}
inline Vec2 vec2(Two pair) noexcept {
  Vec2 x;
  std::memcpy(x.data(), &pair, sizeof pair);
  return x;
}

}  // namespace tactum::inline v0_1
