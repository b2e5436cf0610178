#pragma once
/// Errors of set-up work (files, devices, settings): a value or a sentence that states the error.
/// The haptic frame never uses these; it degrades with flags (response/frame_report.h).

#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "tactum/base/assert.h"

namespace tactum::inline v0_1 {

/// An error, stated so that the reader can correct it.
struct Error {
  std::string what;      ///< one clause: "cannot read the mesh"
  std::string found;     ///< the value that was found; may be empty
  std::string expected;  ///< the value that was expected; may be empty
  std::string where;     ///< file, line and column, field, or device; may be empty

  /// "WHERE: WHAT: found FOUND, expected EXPECTED".
  std::string message() const {
    std::string text;
    if (!where.empty()) text += where + ": ";
    text += what;
    if (!found.empty()) text += ": found " + found;
    if (!expected.empty()) text += (found.empty() ? ": expected " : ", expected ") + expected;
    return text;
  }
};

/// A T or an Error. Check `if (!result)` before `*result`: asserted in every build.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::move(value)) {}
  Result(Error error) : state_(std::move(error)) {}

  explicit operator bool() const { return state_.index() == 0; }
  T& operator*() & { return checked(); }
  const T& operator*() const& { return const_cast<Result*>(this)->checked(); }
  T&& operator*() && { return std::move(checked()); }
  T* operator->() { return &checked(); }
  const T* operator->() const { return &const_cast<Result*>(this)->checked(); }
  const Error& error() const {
    TACTUM_DEMAND(!*this);
    return std::get<1>(state_);
  }

 private:
  T& checked() {
    TACTUM_DEMAND(*this);
    return std::get<0>(state_);
  }
  std::variant<T, Error> state_;
};

/// Success or an Error.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)) {}

  explicit operator bool() const { return !error_.has_value(); }
  const Error& error() const {
    TACTUM_DEMAND(error_);
    return *error_;
  }

 private:
  std::optional<Error> error_;
};

}  // namespace tactum::inline v0_1
