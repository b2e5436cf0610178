#pragma once
/// Facilities for errors about a description and its file: the first of them, ranges, and words meant.

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tactum/base/nearest_word.h"
#include "tactum/base/result.h"

namespace tactum::inline v0_1 {

/// The range of a number; the ends belong to it unless stated.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool above_low = false;  ///< low itself is outside
};
inline constexpr Range kAny{};
inline constexpr Range kPositive{0.0, std::numeric_limits<double>::infinity(), true};
inline constexpr Range kNotNegative{0.0, std::numeric_limits<double>::infinity(), false};

/// Whether the number is finite and in the range.
bool within(double number, Range range);

/// "more than 0", "0 to 20".
std::string shown(Range range);

/// "one of "a", "b""
std::string one_of(const std::vector<std::string>& words);

/// The known word that `word` was meant to be: the same in another format ("revolute" is a hinge), or the
/// nearest one (base/nearest_word.h); empty when there is none.
std::string meant_word(std::string_view word, const std::vector<std::string>& known);

/// The known words, with the one that was meant before them: ""hinge" (of "free", "hinge")".
std::string one_of_meant(std::string_view word, const std::vector<std::string>& known);

/// The first error, if any.
class FirstError {
 public:
  explicit operator bool() const { return error_.has_value(); }
  const Error& error() const { return *error_; }
  void add(Error error) {
    if (!error_) error_ = std::move(error);
  }

 private:
  std::optional<Error> error_;
};

/// The path of an item under a key of the table at `table`; of the key alone where that is the whole.
std::string item_path(const std::string& table, std::string_view key);

/// The path of an item of an array, counted from 0: "body[2]".
std::string item_path(const std::string& table, std::string_view key, std::size_t index);

/// The name of a table in a file, where tables are counted from 1: "[body 3.joint]" for "body[2].joint".
std::string file_section(std::string_view path);

}  // namespace tactum::inline v0_1
