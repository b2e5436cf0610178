#pragma once
/// FNV-1a over bytes; numbers are taken a word at a time, one step instead of eight, with a shift that
/// carries what the product has moved up down again. Names a frame's outputs so that two runs can be compared
/// bit for bit. Not for secrets.

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace tactum {

class Hash {
 public:
  void add_bytes(const void* data, std::size_t size) noexcept {
    const auto* byte = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < size; ++i) state_ = (state_ ^ byte[i]) * kPrime;
  }
  /// Numbers only: structs may hold padding. By their bits, not their value: zeros have two signs.
  template <class T>
  void add(T value) noexcept {
    static_assert(std::is_arithmetic_v<T> && sizeof value <= sizeof(std::uint64_t));
    std::uint64_t word = 0;
    std::memcpy(&word, &value, sizeof value);
    state_ = (state_ ^ word) * kPrime;
    state_ ^= state_ >> 32;
  }
  std::uint64_t value() const noexcept { return state_; }

 private:
  static constexpr std::uint64_t kPrime = 1099511628211ull;
  std::uint64_t state_ = 14695981039346656037ull;
};

}  // namespace tactum
