#pragma once
/// FNV-1a over bytes; numbers are taken a word at a time, one step instead of eight, with a shift that
/// carries what the product has moved up down again. Not for secrets.

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace tactum::inline v0_1 {

/// A chain of words.
class HashChain {
 public:
  constexpr void add_byte(unsigned char byte) noexcept { state_ = (state_ ^ byte) * kPrime; }
  constexpr void add_word(std::uint64_t word) noexcept {
    state_ = (state_ ^ word) * kPrime;
    state_ ^= state_ >> 32;
  }
  constexpr std::uint64_t value() const noexcept { return state_; }

 private:
  static constexpr std::uint64_t kPrime = 1099511628211ull;
  std::uint64_t state_ = 14695981039346656037ull;
};

/// The bits of a number, not its value: zeros have two signs.
template <class T>
std::uint64_t word_of(T value) noexcept {
  static_assert(std::is_arithmetic_v<T> && sizeof value <= sizeof(std::uint64_t));
  std::uint64_t word = 0;
  std::memcpy(&word, &value, sizeof value);
  return word;
}

class Hash {
 public:
  void add_bytes(const void* data, std::size_t size) noexcept {
    const auto* byte = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < size; ++i) chain_.add_byte(byte[i]);
  }
  /// Numbers only: structs may hold padding.
  template <class T>
  void add(T value) noexcept {
    chain_.add_word(word_of(value));
  }
  std::uint64_t value() const noexcept { return chain_.value(); }

 private:
  HashChain chain_;
};

/// The hash of a frame's outputs, so that two runs can be compared bit for bit. The numbers go around four
/// chains: none waits for the one before it.
class FrameHash {
 public:
  template <class T>
  void add(T value) noexcept {
    HashChain turn = chains_[0];
    turn.add_word(word_of(value));
    chains_ = {chains_[1], chains_[2], chains_[3], turn};
  }
  std::uint64_t value() const noexcept {
    HashChain all;
    for (const HashChain& chain : chains_) all.add_word(chain.value());
    return all.value();
  }

 private:
  std::array<HashChain, 4> chains_;
};

}  // namespace tactum::inline v0_1
