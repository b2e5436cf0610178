#pragma once
/// Scratch memory of one frame: a block taken at load time, handed out by moving a mark, taken back whole at
/// the start of the next frame. Objects in it are trivial; nothing is destroyed.

#include <cstddef>
#include <memory>
#include <span>
#include <type_traits>

namespace tactum {

class FrameArena {
 public:
  explicit FrameArena(std::size_t bytes) : block_(std::make_unique<std::byte[]>(bytes)), size_(bytes) {}

  /// `count` objects with indeterminate values, or an empty span when the arena is full.
  template <class T>
  std::span<T> take(std::size_t count) noexcept {
    static_assert(std::is_trivially_destructible_v<T>);
    const std::size_t start = (used_ + alignof(T) - 1) / alignof(T) * alignof(T);
    if (start > size_ || count > (size_ - start) / sizeof(T)) {
      ++refused_;
      return {};
    }
    used_ = start + count * sizeof(T);
    if (used_ > peak_) peak_ = used_;
    return {reinterpret_cast<T*>(block_.get() + start), count};
  }

  /// Everything taken so far is free again.
  void reset() noexcept { used_ = 0; }
  std::size_t used() const noexcept { return used_; }
  std::size_t peak() const noexcept { return peak_; }        ///< most bytes ever in use
  std::size_t refused() const noexcept { return refused_; }  ///< takes that did not fit

 private:
  std::unique_ptr<std::byte[]> block_;
  std::size_t size_;
  std::size_t used_ = 0;
  std::size_t peak_ = 0;
  std::size_t refused_ = 0;
};

}  // namespace tactum
