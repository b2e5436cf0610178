#pragma once
/// A ring for one producer thread and one consumer thread. Neither ever waits: push fails when the ring is
/// full, pop when it is empty. Storage is allocated once, at construction.

#include <atomic>
#include <cstddef>
#include <type_traits>
#include <vector>

namespace tactum::inline v0_1 {

template <class T>
class SpscRing {
  static_assert(std::is_trivially_copyable_v<T>, "the frame copies reports without calling code");

 public:
  /// Room for at least `capacity` items (rounded up to a power of two).
  explicit SpscRing(std::size_t capacity) : items_(round_up(capacity)), mask_(items_.size() - 1) {}

  std::size_t capacity() const noexcept { return items_.size(); }

  /// Producer only. False, with nothing stored, when the ring is full.
  bool push(const T& item) noexcept {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    if (head - tail_.load(std::memory_order_acquire) == items_.size()) return false;
    items_[head & mask_] = item;
    head_.store(head + 1, std::memory_order_release);
    return true;
  }

  /// Consumer only. False when the ring is empty.
  bool pop(T& item) noexcept {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    if (tail == head_.load(std::memory_order_acquire)) return false;
    item = items_[tail & mask_];
    tail_.store(tail + 1, std::memory_order_release);
    return true;
  }

 private:
  static std::size_t round_up(std::size_t n) {
    std::size_t size = 1;
    while (size < n) size *= 2;
    return size;
  }

  std::vector<T> items_;
  std::size_t mask_;
  alignas(64) std::atomic<std::size_t> head_{0};  // producer's line
  alignas(64) std::atomic<std::size_t> tail_{0};  // consumer's line
};

}  // namespace tactum::inline v0_1
