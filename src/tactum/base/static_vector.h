#pragma once
/// A vector with its room inside, for the frame: it never allocates, and a push that does not fit says so.

#include <algorithm>
#include <array>
#include <cstddef>

#include "tactum/base/assert.h"

namespace tactum {

template <class T, std::size_t N>
class StaticVector {
 public:
  /// False, with nothing stored, when full.
  bool push_back(const T& item) noexcept {
    if (size_ == N) return false;
    items_[size_++] = item;
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
    std::copy_n(items, size_, items_.begin());
  }
  std::size_t size() const noexcept { return size_; }
  bool empty() const noexcept { return size_ == 0; }
  bool full() const noexcept { return size_ == N; }
  static constexpr std::size_t capacity() noexcept { return N; }

  T& operator[](std::size_t i) noexcept {
    TACTUM_ASSERT(i < size_);
    return items_[i];
  }
  const T& operator[](std::size_t i) const noexcept {
    TACTUM_ASSERT(i < size_);
    return items_[i];
  }
  T& back() noexcept { return (*this)[size_ - 1]; }
  T* begin() noexcept { return items_.data(); }
  T* end() noexcept { return items_.data() + size_; }
  const T* begin() const noexcept { return items_.data(); }
  const T* end() const noexcept { return items_.data() + size_; }

 private:
  std::array<T, N> items_{};
  std::size_t size_ = 0;
};

}  // namespace tactum
