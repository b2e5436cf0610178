#pragma once
/// FNV-1a over bytes: names a frame's outputs so that two runs can be compared bit for bit. Not for secrets.

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace tactum {

class Hash {
 public:
  void add_bytes(const void* data, std::size_t size) noexcept {
    const auto* byte = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < size; ++i) state_ = (state_ ^ byte[i]) * 1099511628211ull;
  }
  /// Numbers only: structs may hold padding.
  template <class T>
  void add(T value) noexcept {
    static_assert(std::is_arithmetic_v<T>);
    add_bytes(&value, sizeof value);
  }
  std::uint64_t value() const noexcept { return state_; }

 private:
  std::uint64_t state_ = 14695981039346656037ull;
};

}  // namespace tactum
