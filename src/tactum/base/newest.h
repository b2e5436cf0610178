#pragma once
/// The newest value of something, from one thread to one other: three copies, of which the writer fills one,
/// the reader reads one, and the third holds the last finished one. Neither waits; a value that the reader
/// was too slow for is overwritten.
///
///   writer:  fill writable(), publish()          reader:  if (take()) ... readable()

#include <array>
#include <atomic>

namespace tactum::inline v0_1 {

template <class T>
class Newest {
 public:
  /// `prepare` makes each of the copies ready, such as by reserving its memory.
  template <class Prepare>
  explicit Newest(Prepare prepare) {
    for (T& copy : copies_) prepare(copy);
  }

  /// Writer only: the value of the next publish(). It holds some older value.
  T& writable() noexcept { return copies_[writing_]; }
  void publish() noexcept {
    writing_ =
        middle_.exchange(static_cast<unsigned char>(writing_ | kFresh), std::memory_order_acq_rel) & kIndex;
  }

  /// Reader only: true when something was published since the last take.
  bool take() noexcept {
    if ((middle_.load(std::memory_order_relaxed) & kFresh) == 0) return false;
    reading_ = middle_.exchange(reading_, std::memory_order_acq_rel) & kIndex;
    return true;
  }
  const T& readable() const noexcept { return copies_[reading_]; }

 private:
  static constexpr unsigned char kIndex = 3, kFresh = 4;
  std::array<T, 3> copies_{};
  unsigned char writing_ = 0;
  std::atomic<unsigned char> middle_{1};
  unsigned char reading_ = 2;
};

}  // namespace tactum::inline v0_1
