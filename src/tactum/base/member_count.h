#pragma once
/// How many members a struct of plain members has, its bases counted as one each: so that a list of them
/// which stands elsewhere can be held complete when it is compiled.

#include <cstddef>

namespace tactum::inline v0_1 {
namespace member_count_detail {

/// Converts to any member of an aggregate.
struct AnyMember {
  template <class T>
  operator T() const noexcept;  // NOLINT: an initializer of everything
};

template <class Struct, class... Members>
consteval std::size_t count() {
  if constexpr (requires { Struct{Members{}..., AnyMember{}}; })
    return count<Struct, Members..., AnyMember>();
  else
    return sizeof...(Members);
}

}  // namespace member_count_detail

template <class Struct>
inline constexpr std::size_t kMemberCount = member_count_detail::count<Struct>();

}  // namespace tactum::inline v0_1
