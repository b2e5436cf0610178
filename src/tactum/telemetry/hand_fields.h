#pragma once
/// The fields of a report that each hand has of its own (HandReport), among all of them.

#include <type_traits>

#include "tactum/haptics/report_fields.h"

namespace tactum::inline v0_1 {

namespace hand_fields_detail {
template <class Owner, class Value>
constexpr bool is_of_hand(Value Owner::*) {
  return std::is_same_v<Owner, HandReport>;
}
template <auto First, auto... Path>
constexpr bool is_of_hand(const std::type_identity<ReportPath<First, Path...>>&) {
  return is_of_hand(First);
}
}  // namespace hand_fields_detail

/// Calls `visit` with the ReportField of each in turn, as for_each_report_field() does.
template <class Visit>
constexpr void for_each_hand_field(const Visit& visit) {
  for_each_report_field([&](auto field) {
    using Path = decltype(report_detail::kFields)::template At<decltype(field)::kPlace>;
    if constexpr (hand_fields_detail::is_of_hand(std::type_identity<Path>{})) visit(field);
  });
}

}  // namespace tactum::inline v0_1
