#pragma once
/// A small store for what two walks down trees make again and again.

#include <array>
#include <cstddef>
#include <cstdint>

namespace tactum::inline v0_1 {

/// Values turned into the other's frame, kept for the pairs that follow, which mostly need the same again.
/// The room is filled as far as it is used.
template <class Value, std::size_t Room>
class Kept {
 public:
  Kept() noexcept { key_.fill(~0U); }  // NOLINT(cppcoreguidelines-pro-type-member-init)
  /// The value with this key, which make(value) makes when it is not there.
  template <class Make>
  const Value& get(std::uint32_t key, const Make& make) noexcept {
    const std::size_t slot = key % Room;
    if (key_[slot] != key) {
      key_[slot] = key;
      make(value_[slot]);
    }
    return value_[slot];
  }

 private:
  std::array<std::uint32_t, Room> key_;
  std::array<Value, Room> value_;
};

}  // namespace tactum::inline v0_1
