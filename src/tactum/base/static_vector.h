#pragma once
/// A vector with its room inside, for the frame: it never allocates, and a push that does not fit says so.
/// Room that is not in use costs nothing: neither made nor copied.

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <type_traits>

#include "tactum/base/assert.h"

namespace tactum {

template <class T, std::size_t N>
class StaticVector {
  static_assert(std::is_trivially_destructible_v<T>, "items are forgotten, not destroyed");

 public:
  StaticVector() noexcept {}  // NOLINT(modernize-use-equals-default): that fills the room
  StaticVector(const StaticVector& other) noexcept { assign(other.begin(), other.size_); }
  StaticVector& operator=(const StaticVector& other) noexcept {
    if (this != &other) assign(other.begin(), other.size_);
    return *this;
  }
  ~StaticVector() = default;

  /// False, with nothing stored, when full.
  bool push_back(const T& item) noexcept {
    if (size_ == N) return false;
    std::construct_at(room_.items.data() + size_++, item);
    return true;
  }
  void pop_back() noexcept {
    TACTUM_ASSERT(size_ > 0);
    --size_;
  }
  void clear() noexcept { size_ = 0; }
  /// The first `count` of `items`, as many of them as fit.
  void assign(const T* items, std::size_t count) noexcept {
    size_ = count < N ? count : N;
    std::uninitialized_copy_n(items, size_, room_.items.data());
  }
  std::size_t size() const noexcept { return size_; }
  bool empty() const noexcept { return size_ == 0; }
  bool full() const noexcept { return size_ == N; }
  static constexpr std::size_t capacity() noexcept { return N; }

  T& operator[](std::size_t i) noexcept {
    TACTUM_ASSERT(i < size_);
    return room_.items[i];
  }
  const T& operator[](std::size_t i) const noexcept {
    TACTUM_ASSERT(i < size_);
    return room_.items[i];
  }
  T& back() noexcept { return (*this)[size_ - 1]; }
  T* begin() noexcept { return room_.items.data(); }
  T* end() noexcept { return room_.items.data() + size_; }
  const T* begin() const noexcept { return room_.items.data(); }
  const T* end() const noexcept { return room_.items.data() + size_; }

 private:
  union Room {
    Room() noexcept {}  // NOLINT(modernize-use-equals-default): items are made one by one
    std::array<T, N> items;
  };
  Room room_;
  std::size_t size_ = 0;
};

}  // namespace tactum
