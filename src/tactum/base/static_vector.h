#pragma once
/// A vector with its room inside, for the frame: it never allocates, and a push that does not fit returns
/// false. Room that is not in use costs nothing: neither made nor copied.

#include <algorithm>
#include <cstddef>
#include <memory>
#include <new>
#include <type_traits>

#include "tactum/base/assert.h"

namespace tactum::inline v0_1 {

template <class T, std::size_t N>
class StaticVector {
  static_assert(std::is_trivially_destructible_v<T>, "items are forgotten, not destroyed");

 public:
  // NOLINTBEGIN(modernize-use-equals-default,cppcoreguidelines-pro-type-member-init): the room is not filled
  StaticVector() noexcept {}
  StaticVector(const StaticVector& other) noexcept { assign(other.begin(), other.size_); }
  // NOLINTEND(modernize-use-equals-default,cppcoreguidelines-pro-type-member-init)
  StaticVector& operator=(const StaticVector& other) noexcept {
    if (this != &other) assign(other.begin(), other.size_);
    return *this;
  }
  ~StaticVector() = default;

  /// False, with nothing stored, when full.
  bool push_back(const T& item) noexcept {
    if (size_ == N) return false;
    ::new (static_cast<void*>(room_ + size_ * sizeof(T))) T(item);
    ++size_;
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
    std::uninitialized_copy_n(items, size_, begin());
  }
  /// item(0), item(1), ...: `count` items, as many of them as fit.
  template <class Item>
  void fill(std::size_t count, const Item& item) noexcept {
    size_ = count < N ? count : N;
    for (std::size_t i = 0; i < size_; ++i) ::new (static_cast<void*>(room_ + i * sizeof(T))) T(item(i));
  }
  /// Takes what `write(begin)` writes there, up to the end it returns; the writer must know that there is
  /// room.
  template <class Write>
  void overwrite(const Write& write) noexcept {
    size_ = static_cast<std::size_t>(write(begin()) - begin());
    TACTUM_ASSERT(size_ <= N);
  }
  std::size_t size() const noexcept { return size_; }
  bool empty() const noexcept { return size_ == 0; }
  bool full() const noexcept { return size_ == N; }
  static constexpr std::size_t capacity() noexcept { return N; }

  T& operator[](std::size_t i) noexcept {
    TACTUM_ASSERT(i < size_);
    return begin()[i];
  }
  const T& operator[](std::size_t i) const noexcept {
    TACTUM_ASSERT(i < size_);
    return begin()[i];
  }
  T& back() noexcept { return (*this)[size_ - 1]; }
  T* begin() noexcept { return reinterpret_cast<T*>(room_); }
  T* end() noexcept { return begin() + size_; }
  const T* begin() const noexcept { return reinterpret_cast<const T*>(room_); }
  const T* end() const noexcept { return begin() + size_; }

 private:
  alignas(T) std::byte room_[N * sizeof(T)];
  std::size_t size_ = 0;
};

}  // namespace tactum::inline v0_1
