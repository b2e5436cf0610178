#pragma once
/// Arrays that are read a few numbers at a time at places that cannot be predicted. Each begins on a cache
/// line, and occupies no more of them than it must. From 2 MB on large pages are requested of the system: a
/// piece of 40 000 vertices lies in 30 MB, and with pages of 4 KB the processor would need two look-ups for
/// half of its reads, one of them for the page. Without large pages the memory is as good.

#include <cstddef>
#include <limits>
#include <new>
#include <vector>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace tactum::inline v0_1 {

/// For std::vector; as the standard one, with the alignment above.
template <class T>
struct LargeArrayAllocator {
  using value_type = T;  // NOLINT(readability-identifier-naming): so std::allocator_traits calls it

  LargeArrayAllocator() noexcept = default;
  template <class U>
  LargeArrayAllocator(const LargeArrayAllocator<U>&) noexcept {}  // NOLINT(google-explicit-constructor)

  /// `count` objects without values. Throws std::bad_alloc.
  T* allocate(std::size_t count) {
    if (count > kMost) throw std::bad_array_new_length();
    const std::size_t bytes = count * sizeof(T);
    if (bytes < kLargePage) return static_cast<T*>(::operator new(bytes, kLine));
    void* block = ::operator new(whole_pages(bytes), kPage);
#if defined(__linux__)
    madvise(block, whole_pages(bytes), MADV_HUGEPAGE);  // advice: without it the memory is as good
#endif
    return static_cast<T*>(block);
  }

  void deallocate(T* block, std::size_t count) noexcept {
    ::operator delete(block, count * sizeof(T) < kLargePage ? kLine : kPage);
  }

  template <class U>
  bool operator==(const LargeArrayAllocator<U>&) const noexcept {
    return true;  // memory of any allocator can be freed by any other
  }

 private:
  static constexpr std::size_t kLargePage = std::size_t{2} << 20;
  static constexpr std::size_t kMost = std::numeric_limits<std::ptrdiff_t>::max() / sizeof(T) - kLargePage;
  static constexpr std::align_val_t kLine{64};
  static constexpr std::align_val_t kPage{kLargePage};

  static std::size_t whole_pages(std::size_t bytes) noexcept {
    return (bytes + kLargePage - 1) / kLargePage * kLargePage;
  }
};

template <class T>
using LargeArray = std::vector<T, LargeArrayAllocator<T>>;

}  // namespace tactum::inline v0_1
