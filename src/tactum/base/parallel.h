#pragma once
/// Work of preparation on several threads. For set-up only: threads are started for each call and end with
/// it, and the frame starts none.
///
/// Results do not depend on how many threads there are: ranges are the same for any number, each is worked on
/// by one thread, and bodies write only what belongs to their range. What is summed up or ordered is put
/// together by the caller afterwards, range by range.
///
/// An exception ends the work: the ranges that are begun are finished, and the caller gets the exception of
/// the lowest range, whatever the number of threads. Where the system gives no more threads, those that there
/// are do the work.

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace tactum::inline v0_1 {

/// The cores of the machine, or those that this process may use where the system says so; at least one.
inline int all_cores() noexcept { return std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }

/// Calls body(first, last) for [0, block), [block, 2 block) ... of [0, count), on at most `threads` threads,
/// the caller's among them.
template <class Body>
void for_ranges(int threads, std::size_t count, std::size_t block, Body&& body) {
  const std::size_t ranges = (count + block - 1) / block;
  std::atomic<std::size_t> next{0};
  std::mutex failed;
  std::size_t failed_range = ranges;
  std::exception_ptr failure;
  const auto work = [&]() noexcept {
    for (;;) {
      const std::size_t range = next.fetch_add(1);
      if (range >= ranges) return;
      try {
        body(range * block, std::min(count, (range + 1) * block));
      } catch (...) {
        const std::lock_guard lock(failed);
        // Ranges are handed out in ascending order, so that all below this one are done or under way.
        next.store(ranges);
        if (range >= failed_range) continue;
        failed_range = range;
        failure = std::current_exception();
      }
    }
  };
  std::vector<std::thread> helpers;
  const auto wanted = std::min<std::size_t>(static_cast<std::size_t>(std::max(threads, 1)), ranges);
  helpers.reserve(wanted);
  try {
    for (std::size_t i = 1; i < wanted; ++i) helpers.emplace_back(work);
  } catch (const std::exception&) {  // the system gives no more threads, or no memory for one
  }
  work();
  for (std::thread& helper : helpers) helper.join();
  if (failure) std::rethrow_exception(failure);
}

/// Calls first(share) and second(share), at the same time where there are two threads or more; `share` is how
/// many of them each may use.
template <class First, class Second>
void for_both(int threads, First&& first, Second&& second) {
  const int others = std::max(threads, 1) / 2;
  const int own = others > 0 ? threads - others : 1;
  for_ranges(threads, 2, 1, [&](std::size_t which, std::size_t) {
    if (which == 0) {
      first(own);
    } else {
      second(std::max(others, 1));
    }
  });
}

}  // namespace tactum::inline v0_1
