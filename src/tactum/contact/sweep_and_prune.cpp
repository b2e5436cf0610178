#include "tactum/contact/sweep_and_prune.h"

#include <algorithm>
#include <bit>

namespace tactum::inline v0_1 {
namespace {

constexpr std::size_t kBoxesWithAllPairs = 128;
constexpr std::size_t kPairsOfABox = 64;

}  // namespace

std::size_t SweepAndPrune::room_for(std::size_t boxes) noexcept {
  const std::size_t all = boxes < 2 ? 0 : boxes * (boxes - 1) / 2;
  return boxes <= kBoxesWithAllPairs ? all : std::min(all, kPairsOfABox * boxes);
}

SweepAndPrune::SweepAndPrune(const std::vector<Aabb>& boxes, std::size_t room) : boxes_(boxes), room_(room) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<End>& ends = axes_[axis];
    for (std::size_t i = 0; i < boxes_.size(); ++i) {
      ends.push_back({boxes_[i].min[static_cast<int>(axis)], static_cast<std::int32_t>(i), false});
      ends.push_back({boxes_[i].max[static_cast<int>(axis)], static_cast<std::int32_t>(i), true});
    }
    std::stable_sort(ends.begin(), ends.end(), [](const End& a, const End& b) { return a.before(b); });
    ends_of_[axis].resize(boxes_.size());
    for (std::size_t k = 0; k < ends.size(); ++k) place_of(axis, ends[k]) = static_cast<std::int32_t>(k);
  }
  pairs_.reserve(room_);
  open_.reserve(boxes_.size());
  free_slots_.reserve(room_);
  for (std::size_t slot = room_; slot > 0; --slot) free_slots_.push_back(static_cast<std::int32_t>(slot - 1));
  table_.assign(std::bit_ceil(2 * room_ + 1), -1);
  list_all();
}

void SweepAndPrune::move(int i, const Aabb& box) noexcept {
  boxes_[static_cast<std::size_t>(i)] = box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Ends& ends = ends_of_[axis][static_cast<std::size_t>(i)];
    axes_[axis][static_cast<std::size_t>(ends.lower)].value = box.min[static_cast<int>(axis)];
    axes_[axis][static_cast<std::size_t>(ends.upper)].value = box.max[static_cast<int>(axis)];
  }
}

int SweepAndPrune::update() noexcept {
  int swaps = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<End>& ends = axes_[axis];
    for (std::size_t k = 1; k < ends.size(); ++k) {
      const End moving = ends[k];
      std::size_t at = k;
      while (at > 0 && moving.before(ends[at - 1])) {
        const End& passed = ends[at - 1];
        if (!moving.upper && passed.upper) begin_overlap(moving.box, passed.box);
        if (moving.upper && !passed.upper) end_overlap(moving.box, passed.box);
        ends[at] = passed;
        place_of(axis, passed) = static_cast<std::int32_t>(at);
        --at;
        ++swaps;
      }
      if (at == k) continue;
      ends[at] = moving;
      place_of(axis, moving) = static_cast<std::int32_t>(at);
    }
  }
  if (missing_ > 0) list_all();
  return swaps;
}

/// Lists every pair that overlaps and is not listed yet, by one sweep along the first axis.
void SweepAndPrune::list_all() noexcept {
  missing_ = 0;
  open_.clear();
  for (const End& end : axes_[0]) {
    if (end.upper) {
      *std::find(open_.begin(), open_.end(), end.box) = open_.back();
      open_.pop_back();
      continue;
    }
    for (const std::int32_t other : open_) begin_overlap(end.box, other);
    open_.push_back(end.box);
  }
}

/// Lists a pair of boxes whose overlap has begun on one axis, if they overlap on all. Every box stands where
/// it is at the end of the update, so the last axis on which an overlap begins finds it on all three.
void SweepAndPrune::begin_overlap(std::int32_t box, std::int32_t other) noexcept {
  if (box == other ||
      !boxes_[static_cast<std::size_t>(box)].overlaps(boxes_[static_cast<std::size_t>(other)]))
    return;
  const auto [a, b] = std::minmax(box, other);
  std::int32_t& entry = table_[entry_of(a, b)];
  if (entry >= 0) return;
  if (pairs_.size() == room_) {
    ++missing_;
    return;
  }
  entry = static_cast<std::int32_t>(pairs_.size());
  pairs_.push_back({a, b, free_slots_.back()});
  free_slots_.pop_back();
}

void SweepAndPrune::end_overlap(std::int32_t box, std::int32_t other) noexcept {
  const auto [a, b] = std::minmax(box, other);
  const std::size_t entry = entry_of(a, b);
  if (table_[entry] < 0) return;
  const std::size_t at = static_cast<std::size_t>(table_[entry]);
  free_slots_.push_back(pairs_[at].slot);
  if (at + 1 < pairs_.size()) {
    table_[entry_of(pairs_.back().a, pairs_.back().b)] = static_cast<std::int32_t>(at);
    pairs_[at] = pairs_.back();
  }
  pairs_.pop_back();
  erase(entry);
}

/// Where the pair stands in the table, or would stand: the first entry from its own on that is its or empty.
std::size_t SweepAndPrune::entry_of(std::int32_t a, std::int32_t b) const noexcept {
  for (std::size_t entry = home_of(a, b);; entry = next(entry)) {
    if (table_[entry] < 0) return entry;
    const Pair& pair = pairs_[static_cast<std::size_t>(table_[entry])];
    if (pair.a == a && pair.b == b) return entry;
  }
}

std::size_t SweepAndPrune::home_of(std::int32_t a, std::int32_t b) const noexcept {
  const std::uint64_t key = (static_cast<std::uint64_t>(a) << 32) | static_cast<std::uint64_t>(b);
  return (key * 0x9e3779b97f4a7c15ull >> 32) & (table_.size() - 1);  // Fibonacci hashing
}

/// Empties an entry, and moves those behind it that could no longer be found from their own.
void SweepAndPrune::erase(std::size_t entry) noexcept {
  std::size_t hole = entry;
  for (std::size_t at = next(hole); table_[at] >= 0; at = next(at)) {
    const Pair& pair = pairs_[static_cast<std::size_t>(table_[at])];
    const std::size_t home = home_of(pair.a, pair.b);
    const std::size_t mask = table_.size() - 1;
    if (((at - home) & mask) < ((at - hole) & mask)) continue;  // its own entry lies behind the hole
    table_[hole] = table_[at];
    hole = at;
  }
  table_[hole] = -1;
}

}  // namespace tactum::inline v0_1
