#pragma once
/// The state that is carried from frame to frame, as bytes and back, whatever types hold it:
///
///   numbers, flags, names        as they lie in memory
///   struct of plain members      each member in turn: one that is added is carried without a word here
///   class, or struct with more   what its `carried(self, visit)` passes to `visit`; the rest is scratch
///   lists                        their length, which must fit in the room that is there, then their items
///
/// A pointer is no state: a type with one does not compile here. Writing allocates nothing and has no bound
/// but the state's size, so the loop's thread may do it. The bytes are those of this program on this kind of
/// machine, with any compiler; layout_of() tells whether two programs carry the same.

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>
#include <variant>

#include "tactum/base/hash.h"
#include "tactum/base/member_count.h"
#include "tactum/base/reserved_vector.h"
#include "tactum/base/static_vector.h"

namespace tactum::inline v0_1 {

/// Writes into room that is given; what does not fit is only counted.
class StateWriter {
 public:
  explicit StateWriter(std::span<char> room) noexcept : room_(room) {}
  template <class Number>
  void numbers(const Number* from, std::size_t count) noexcept {
    const std::size_t bytes = count * sizeof(Number);
    if (bytes > 0 && size_ <= room_.size() && bytes <= room_.size() - size_)  // an empty list has no memory
      std::memcpy(room_.data() + size_, from, bytes);
    size_ += bytes;
  }
  /// Bytes so far, those without room included.
  std::size_t size() const noexcept { return size_; }

 private:
  std::span<char> room_;
  std::size_t size_ = 0;
};

/// Reads from bytes that anybody may have written; after the first that cannot be the state's, nothing more
/// changes and good() is false.
class StateReader {
 public:
  explicit StateReader(std::string_view bytes) noexcept : bytes_(bytes) {}
  template <class Number>
  void numbers(Number* to, std::size_t count) noexcept {
    const std::size_t size = count * sizeof(Number);
    good_ = good_ && size <= bytes_.size() - at_;
    if (!good_ || size == 0) return;
    if constexpr (std::is_same_v<Number, bool>) {  // any other byte in a bool would be undefined
      const std::string_view raw = bytes_.substr(at_, size);
      good_ = std::all_of(raw.begin(), raw.end(), [](char byte) { return byte == 0 || byte == 1; });
      if (!good_) return;
    }
    std::memcpy(to, bytes_.data() + at_, size);
    at_ += size;
  }
  void refuse() noexcept { good_ = false; }
  bool good() const noexcept { return good_; }
  std::size_t at() const noexcept { return at_; }
  bool done() const noexcept { return good_ && at_ == bytes_.size(); }

 private:
  std::string_view bytes_;
  std::size_t at_ = 0;
  bool good_ = true;
};

/// Sees the types alone.
class StateLayout {
 public:
  template <class Number>
  void numbers(const Number*, std::size_t count) noexcept {
    add(count * 4 + (std::is_floating_point_v<Number> ? 1 : std::is_enum_v<Number> ? 2 : 3));
    add(sizeof(Number));
  }
  void add(std::size_t number) noexcept { hash_.add(static_cast<std::uint64_t>(number)); }
  std::uint64_t value() const noexcept { return hash_.value(); }

 private:
  FrameHash hash_;
};

namespace carried_detail {

/// Passes the members of a struct, bases excepted, to `visit`.
template <class Struct, class Visit>
void visit_members(Struct& value, Visit& visit) noexcept {
  constexpr std::size_t kCount = kMemberCount<std::remove_const_t<Struct>>;
  static_assert(kCount >= 1 && kCount <= 13, "give this type a function `carried`");
  if constexpr (kCount == 1) {
    auto& [a] = value;
    visit(a);
  } else if constexpr (kCount == 2) {
    auto& [a, b] = value;
    visit(a, b);
  } else if constexpr (kCount == 3) {
    auto& [a, b, c] = value;
    visit(a, b, c);
  } else if constexpr (kCount == 4) {
    auto& [a, b, c, d] = value;
    visit(a, b, c, d);
  } else if constexpr (kCount == 5) {
    auto& [a, b, c, d, e] = value;
    visit(a, b, c, d, e);
  } else if constexpr (kCount == 6) {
    auto& [a, b, c, d, e, f] = value;
    visit(a, b, c, d, e, f);
  } else if constexpr (kCount == 7) {
    auto& [a, b, c, d, e, f, g] = value;
    visit(a, b, c, d, e, f, g);
  } else if constexpr (kCount == 8) {
    auto& [a, b, c, d, e, f, g, h] = value;
    visit(a, b, c, d, e, f, g, h);
  } else if constexpr (kCount == 9) {
    auto& [a, b, c, d, e, f, g, h, i] = value;
    visit(a, b, c, d, e, f, g, h, i);
  } else if constexpr (kCount == 10) {
    auto& [a, b, c, d, e, f, g, h, i, j] = value;
    visit(a, b, c, d, e, f, g, h, i, j);
  } else if constexpr (kCount == 11) {
    auto& [a, b, c, d, e, f, g, h, i, j, k] = value;
    visit(a, b, c, d, e, f, g, h, i, j, k);
  } else if constexpr (kCount == 12) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l] = value;
    visit(a, b, c, d, e, f, g, h, i, j, k, l);
  } else {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m] = value;
    visit(a, b, c, d, e, f, g, h, i, j, k, l, m);
  }
}

template <class T>
concept Number = std::is_arithmetic_v<T> || std::is_enum_v<T>;
template <class T>
concept Matrix = requires(T& m) {
  T::SizeAtCompileTime;
  m.data();
};
template <class T>
concept Choice = requires(T& choice) {
  choice.valueless_by_exception();
};
template <class T>
concept List = requires(T& list) {
  list.begin();
  list.size();
};

template <class T>
inline constexpr bool kIsReserved = false;
template <class T>
inline constexpr bool kIsReserved<ReservedVector<T>> = true;
template <class T>
inline constexpr bool kIsArray = false;
template <class T, std::size_t N>
inline constexpr bool kIsArray<std::array<T, N>> = true;

/// Gives a list the length that was read, where it has room for it.
template <class Items>
bool make_as_long(Items& items, std::uint64_t count) noexcept {
  if constexpr (kIsReserved<Items>) {
    if (count > items.capacity()) return false;
    items.resize(static_cast<std::size_t>(count));
  } else if constexpr (requires { items.overwrite([](auto* end) { return end; }); }) {
    if (count > Items::capacity()) return false;
    items.fill(static_cast<std::size_t>(count),
               [](std::size_t) { return std::remove_cvref_t<decltype(*items.begin())>{}; });
  }
  return count == items.size();
}

}  // namespace carried_detail

/// Leads a writer, a reader or a layout through a state.
template <class End>
class StateVisit {
 public:
  explicit StateVisit(End& end) noexcept : end_(end) {}
  template <class... Values>
  void operator()(Values&... values) noexcept {
    (one(values), ...);
  }

 private:
  template <class T>
  void one(T& value) noexcept {
    using Value = std::remove_const_t<T>;
    static_assert(!std::is_pointer_v<Value>, "a pointer is no state");
    if constexpr (carried_detail::Number<Value>)
      end_.numbers(&value, 1);
    else if constexpr (requires { Value::carried(value, *this); })
      Value::carried(value, *this);
    else if constexpr (carried_detail::Matrix<Value>)
      end_.numbers(value.data(), static_cast<std::size_t>(Value::SizeAtCompileTime));
    else if constexpr (carried_detail::Choice<Value>)
      choice(value);
    else if constexpr (carried_detail::List<Value>)
      list(value);
    else
      carried_detail::visit_members(value, *this);
  }

  /// The alternative is a setting of the run, not state: a reader must find the same.
  template <class Value>
  void choice(Value& value) noexcept {
    std::uint64_t which = value.index();
    end_.numbers(&which, 1);
    if constexpr (std::is_same_v<End, StateReader>)
      if (which != value.index()) return end_.refuse();
    std::visit([this](auto& chosen) { this->one(chosen); }, value);
  }

  template <class Items>
  void list(Items& items) noexcept {
    using Item = std::remove_cvref_t<decltype(*items.begin())>;
    if constexpr (std::is_same_v<End, StateLayout>) {
      end_.add(sizeof(Item));
      end_.add(carried_detail::kIsArray<std::remove_const_t<Items>> ? items.size() : 0);
      return;
    } else if constexpr (!carried_detail::kIsArray<std::remove_const_t<Items>>) {
      std::uint64_t count = items.size();
      end_.numbers(&count, 1);
      if constexpr (std::is_same_v<End, StateReader>)
        if (!end_.good() || !carried_detail::make_as_long(items, count)) return end_.refuse();
    }
    if constexpr (carried_detail::Number<Item>)
      end_.numbers(std::to_address(items.begin()), items.size());
    else
      for (auto& item : items) one(item);
  }

  End& end_;
};

/// A number that differs between programs which carry other things in this state, in another order.
template <class State>
std::uint64_t layout_of(const State& state) noexcept {
  StateLayout layout;
  StateVisit<StateLayout>{layout}(state);
  return layout.value();
}

}  // namespace tactum::inline v0_1
