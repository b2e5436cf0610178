#include "tactum/contact/schedule.h"

#include <algorithm>

namespace tactum::inline v0_1 {
namespace {

/// A strict order without ties, so that every standard library selects the same pairs.
bool goes_before(const DuePair& a, const DuePair& b, int head_start) {
  if (a.priority != b.priority) return a.priority < b.priority;
  const auto since = [head_start](const DuePair& due) {
    return due.last_checked - (due.was_in_contact ? head_start : 0);
  };
  if (since(a) != since(b)) return since(a) < since(b);
  return a.pair < b.pair;
}

}  // namespace

int prioritise(std::span<DuePair> due, int budget, int head_start) noexcept {
  if (static_cast<std::size_t>(std::max(budget, 0)) >= due.size()) return static_cast<int>(due.size());
  const auto cut = due.begin() + std::max(budget, 0);
  std::nth_element(due.begin(), cut, due.end(), [head_start](const DuePair& a, const DuePair& b) {
    return goes_before(a, b, head_start);
  });
  std::sort(due.begin(), cut, [](const DuePair& a, const DuePair& b) { return a.pair < b.pair; });
  return std::max(budget, 0);
}

}  // namespace tactum::inline v0_1
