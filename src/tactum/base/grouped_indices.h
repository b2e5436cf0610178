#pragma once
/// Which items belong to which group, in lists without allocation: the items of every group in rising order.

#include <span>

#include "tactum/base/reserved_vector.h"

namespace tactum::inline v0_1 {

class GroupedIndices {
 public:
  GroupedIndices(std::size_t most_groups, std::size_t most_items) {
    first_.reserve(most_groups + 2);
    items_.reserve(most_items);
    group_.reserve(most_items);
  }
  /// group_of(item) is its group, or -1 for none. Cost: linear in groups and items.
  template <class GroupOf>
  void set(std::size_t groups, std::size_t items, const GroupOf& group_of) noexcept {
    first_.assign(groups + 2, 0);
    group_.resize(items);
    for (std::size_t i = 0; i < items; ++i) {
      group_[i] = group_of(i);
      if (group_[i] >= 0) ++first_[static_cast<std::size_t>(group_[i]) + 2];
    }
    for (std::size_t g = 2; g < first_.size(); ++g) first_[g] += first_[g - 1];
    items_.resize(static_cast<std::size_t>(first_.back()));
    for (std::size_t i = 0; i < items; ++i)
      if (group_[i] >= 0)
        items_[static_cast<std::size_t>(first_[static_cast<std::size_t>(group_[i]) + 1]++)] =
            static_cast<int>(i);
  }
  std::span<const int> operator[](std::size_t group) const noexcept {
    const auto begin = static_cast<std::size_t>(first_[group]);
    return {items_.data() + begin, static_cast<std::size_t>(first_[group + 1]) - begin};
  }

 private:
  ReservedVector<int> first_;  // where each group's items begin
  ReservedVector<int> items_;
  ReservedVector<int> group_;  // of each item
};

}  // namespace tactum::inline v0_1
