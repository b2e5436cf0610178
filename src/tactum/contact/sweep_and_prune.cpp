#include "tactum/contact/sweep_and_prune.h"

#include <algorithm>
#include <utility>

namespace tactum::inline v0_1 {

SweepAndPrune::SweepAndPrune(const std::vector<Aabb>& boxes) : count_(static_cast<int>(boxes.size())) {
  const std::size_t n = boxes.size();
  const std::size_t pair_count = n < 2 ? 0 : n * (n - 1) / 2;
  overlapping_axes_.assign(pair_count, 0);
  listed_at_.assign(pair_count, -1);
  pairs_.reserve(pair_count);
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<End>& ends = axes_[static_cast<std::size_t>(axis)];
    for (int i = 0; i < count_; ++i) {
      ends.push_back({boxes[static_cast<std::size_t>(i)].min[axis], i, false});
      ends.push_back({boxes[static_cast<std::size_t>(i)].max[axis], i, true});
    }
    std::stable_sort(ends.begin(), ends.end(), [](const End& a, const End& b) { return a.before(b); });
    auto& place = place_[static_cast<std::size_t>(axis)];
    place.resize(n);
    for (std::size_t k = 0; k < ends.size(); ++k)
      place[static_cast<std::size_t>(ends[k].box)][ends[k].upper ? 1 : 0] = static_cast<std::int32_t>(k);
  }
  for (int a = 0; a < count_; ++a)
    for (int b = a + 1; b < count_; ++b)
      for (int axis = 0; axis < 3; ++axis) {
        const Aabb& A = boxes[static_cast<std::size_t>(a)];
        const Aabb& B = boxes[static_cast<std::size_t>(b)];
        if (A.min[axis] <= B.max[axis] && B.min[axis] <= A.max[axis]) begin_overlap(a, b);
      }
}

void SweepAndPrune::move(int i, const Aabb& box) noexcept {
  for (int axis = 0; axis < 3; ++axis) {
    auto& ends = axes_[static_cast<std::size_t>(axis)];
    const auto& place = place_[static_cast<std::size_t>(axis)][static_cast<std::size_t>(i)];
    ends[static_cast<std::size_t>(place[0])].value = box.min[axis];
    ends[static_cast<std::size_t>(place[1])].value = box.max[axis];
  }
}

int SweepAndPrune::update() noexcept {
  int swaps = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<End>& ends = axes_[axis];
    auto& place = place_[axis];
    for (std::size_t k = 1; k < ends.size(); ++k) {
      const End moving = ends[k];
      std::size_t at = k;
      while (at > 0 && moving.before(ends[at - 1])) {
        const End& passed = ends[at - 1];
        if (!moving.upper && passed.upper) begin_overlap(moving.box, passed.box);
        if (moving.upper && !passed.upper) end_overlap(moving.box, passed.box);
        ends[at] = passed;
        place[static_cast<std::size_t>(passed.box)][passed.upper ? 1 : 0] = static_cast<std::int32_t>(at);
        --at;
        ++swaps;
      }
      if (at == k) continue;
      ends[at] = moving;
      place[static_cast<std::size_t>(moving.box)][moving.upper ? 1 : 0] = static_cast<std::int32_t>(at);
    }
  }
  return swaps;
}

std::size_t SweepAndPrune::row(int a, int b) const noexcept {
  const auto [low, high] = std::minmax(a, b);
  const std::size_t i = static_cast<std::size_t>(low);
  const std::size_t n = static_cast<std::size_t>(count_);
  return i * (2 * n - i - 1) / 2 + static_cast<std::size_t>(high) - i - 1;
}

void SweepAndPrune::begin_overlap(int a, int b) noexcept {
  if (a == b) return;
  const std::size_t pair = row(a, b);
  if (++overlapping_axes_[pair] < 3) return;
  listed_at_[pair] = static_cast<std::int32_t>(pairs_.size());
  pairs_.push_back({std::min(a, b), std::max(a, b)});
}

void SweepAndPrune::end_overlap(int a, int b) noexcept {
  if (a == b) return;
  const std::size_t pair = row(a, b);
  if (overlapping_axes_[pair]-- < 3) return;
  const std::size_t at = static_cast<std::size_t>(listed_at_[pair]);
  pairs_[at] = pairs_.back();
  listed_at_[row(pairs_[at].a, pairs_[at].b)] = static_cast<std::int32_t>(at);
  pairs_.pop_back();
  listed_at_[pair] = -1;
}

}  // namespace tactum::inline v0_1
