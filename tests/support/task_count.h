#pragma once
/// Threads and waiting, for tests of things that start threads.

#include <chrono>
#include <filesystem>
#include <iterator>
#include <thread>

namespace tactum {

/// The threads that this process has now.
inline int tasks_of_this_process() {
  const std::filesystem::directory_iterator tasks("/proc/self/task");
  return static_cast<int>(std::distance(begin(tasks), end(tasks)));
}

/// Waits until `condition` holds, for a minute at the most; whether it came to hold. How long it takes is
/// not judged.
template <class Condition>
bool comes_true(Condition condition) {
  for (int i = 0; i < 60000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

}  // namespace tactum
