#pragma once
/// Numbers as the page reads them: little-endian, packed, every message a multiple of four bytes.

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>

#include "tactum/math/types.h"

namespace tactum::wire {

static_assert(std::endian::native == std::endian::little, "the page reads little-endian numbers");

template <class T>
void put(std::string& out, T value) {
  static_assert(std::is_arithmetic_v<T>);
  const std::size_t at = out.size();
  out.resize(at + sizeof value);
  std::memcpy(out.data() + at, &value, sizeof value);
}

inline void put(std::string& out, const Vec3& v) {
  for (int i = 0; i < 3; ++i) put(out, static_cast<float>(v[i]));
}

/// Overwrites what was put at `at`.
template <class T>
void put_at(std::string& out, std::size_t at, T value) {
  std::memcpy(out.data() + at, &value, sizeof value);
}

}  // namespace tactum::wire
