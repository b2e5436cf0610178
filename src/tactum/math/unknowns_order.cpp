#include "tactum/math/unknowns_order.h"

#include <algorithm>
#include <array>
#include <limits>

namespace tactum::inline v0_1 {
namespace {

using Index = std::size_t;
using std::uint32_t;
constexpr uint32_t kNotPlaced = std::numeric_limits<uint32_t>::max();

}  // namespace

UnknownsOrder::UnknownsOrder(std::size_t most_rows, std::size_t most_segments, std::size_t most_unknowns) {
  for (ReservedVector<uint32_t>* const of_unknowns : {&segment_of_, &places_, &envelope_})
    of_unknowns->reserve(most_unknowns);
  for (ReservedVector<uint32_t>* const of_segments : {&first_of_, &edges_from_, &order_, &placed_})
    of_segments->reserve(most_segments + 1);
  edges_.reserve(2 * most_rows);
}

void UnknownsOrder::begin() noexcept {
  edges_.clear();
  segment_of_.clear();
  first_of_.assign(1, 0);
}

void UnknownsOrder::add_segment(std::size_t unknowns) noexcept {
  segment_of_.insert(segment_of_.end(), unknowns, static_cast<Segment>(segments()));
  first_of_.push_back(static_cast<uint32_t>(segment_of_.size()));
}

void UnknownsOrder::connect(const QpRow& row) noexcept {
  std::array<Segment, 4> found{};  // a run may begin with a joint's unknown, in the segment before
  Index n = 0;
  for (const QpRow::Run& run : row.runs) {
    if (run.count == 0) continue;
    found[n++] = segment_of_[run.first];
    found[n++] = segment_of_[run.first + run.count - 1];
  }
  for (Index i = 0; i < n; ++i)
    for (Index j = i + 1; j < n; ++j) {
      const Edge edge = std::minmax(found[i], found[j]);
      // Rows of one patch follow each other, and connect the same bodies.
      const bool known = edge.first == edge.second || (!edges_.empty() && edges_.back() == edge);
      if (!known && 2 * edges_.size() < edges_.capacity()) edges_.push_back(edge);
    }
}

/// Numbers the segments that are connected with `start`, the nearest first, from `number` on; returns the
/// last one.
UnknownsOrder::Segment UnknownsOrder::order_from(Segment start, std::size_t number) noexcept {
  const auto degree = [&](Segment s) { return edges_from_[s + 1] - edges_from_[s]; };
  order_.resize(number);
  order_.push_back(start);
  placed_[start] = static_cast<uint32_t>(number);
  for (Index i = number; i < order_.size(); ++i) {
    const auto first_new = static_cast<std::ptrdiff_t>(order_.size());
    for (uint32_t e = edges_from_[order_[i]]; e < edges_from_[order_[i] + 1]; ++e) {
      const Segment other = edges_[e].second;
      if (placed_[other] != kNotPlaced) continue;
      placed_[other] = static_cast<uint32_t>(order_.size());
      order_.push_back(other);
    }
    std::sort(order_.begin() + first_new, order_.end(),
              [&](Segment a, Segment b) { return degree(a) != degree(b) ? degree(a) < degree(b) : a < b; });
  }
  return order_.back();
}

bool UnknownsOrder::find() noexcept {
  if (2 * edges_.size() >= edges_.capacity()) return false;
  const Index edges = edges_.size();
  for (Index e = 0; e < edges; ++e) edges_.emplace_back(edges_[e].second, edges_[e].first);
  std::sort(edges_.begin(), edges_.end());
  edges_.erase(std::unique(edges_.begin(), edges_.end()), edges_.end());
  edges_from_.assign(segments() + 1, 0);
  for (const Edge& edge : edges_) ++edges_from_[edge.first + 1];
  for (Index s = 0; s < segments(); ++s) edges_from_[s + 1] += edges_from_[s];

  placed_.assign(segments(), kNotPlaced);
  order_.clear();
  for (Index s = 0; s < segments(); ++s) {
    if (placed_[s] != kNotPlaced) continue;
    // From the far end of what is connected: the levels of distance are narrow then.
    const Index number = order_.size();
    const Segment far = order_from(static_cast<Segment>(s), number);
    for (Index i = number; i < order_.size(); ++i) placed_[order_[i]] = kNotPlaced;
    order_from(far, number);
  }
  std::reverse(order_.begin(), order_.end());

  uint32_t place = 0;
  places_.resize(segment_of_.size());
  for (const Segment s : order_) {
    placed_[s] = place;
    for (uint32_t u = first_of_[s]; u < first_of_[s + 1]; ++u) places_[u] = place++;
  }
  envelope_.resize(segment_of_.size());
  for (Index s = 0; s < segments(); ++s) {
    uint32_t first = placed_[s];
    for (uint32_t e = edges_from_[s]; e < edges_from_[s + 1]; ++e)
      first = std::min(first, placed_[edges_[e].second]);
    for (uint32_t u = first_of_[s]; u < first_of_[s + 1]; ++u) envelope_[places_[u]] = first;
  }
  return true;
}

}  // namespace tactum::inline v0_1
