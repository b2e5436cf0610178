#pragma once
/// Strict reading of TOML tables: every key a table may have is named when it is opened, anything else in it
/// is an error that names the nearest known key; every value has a type and a range. Errors tell file, line
/// and column.
///
///   const TomlReader hand = scene.table("hand", {"grip", "tremor", "step"});
///   const std::string grip = hand.text("grip", "medium");
///   if (errors) ...                                   the first error is kept, later ones are not
///
/// A reader given a wrong value remembers the first error and goes on with the fallback, so that a section
/// reads as a list of its keys. For src/tactum/scene/*.cpp only: it shows toml++, which the layer uses
/// privately.

#include <toml++/toml.h>
#include <initializer_list>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tactum/base/result.h"
#include "tactum/math/pose.h"

namespace tactum {

/// Where a number may lie; the ends belong to it unless said.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool above_low = false;  ///< low itself is outside
};
inline constexpr Range kAny{};
inline constexpr Range kPositive{0.0, std::numeric_limits<double>::infinity(), true};
inline constexpr Range kNotNegative{0.0, std::numeric_limits<double>::infinity(), false};

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

/// The known word nearest to `word` by Damerau-Levenshtein distance, when near enough to be meant; else
/// empty.
std::string nearest_word(std::string_view word, const std::vector<std::string>& known);

class TomlReader {
 public:
  using Keys = std::initializer_list<const char*>;

  /// `path` is the table's dotted name, empty for the whole file; `file` names the source. All references
  /// must outlive the reader.
  TomlReader(const toml::table& table, const std::string& file, std::string path,
             std::span<const char* const> keys, FirstError& errors);
  TomlReader(const toml::table& table, const std::string& file, std::string path, Keys keys,
             FirstError& errors)
      : TomlReader(table, file, std::move(path), std::span(keys.begin(), keys.size()), errors) {}

  bool has(const char* key) const { return table_.contains(key); }
  /// "[body 2.joint]", or "the scene" for the whole file.
  std::string section() const { return path_.empty() ? "the scene" : "[" + path_ + "]"; }
  FirstError& errors() const { return errors_; }

  // With a fallback a key may be absent; without one it must be there.
  double number(const char* key, std::optional<double> fallback = {}, Range range = kAny) const;
  int integer(const char* key, std::optional<int> fallback, int low, int high) const;
  bool flag(const char* key, bool fallback) const;
  std::string text(const char* key, std::optional<std::string> fallback = {}) const;
  /// A text that must be one of `choices`.
  std::string choice(const char* key, std::optional<std::string> fallback,
                     const std::vector<std::string>& choices) const;
  std::vector<double> numbers(const char* key, std::size_t count) const;
  Vec3 vector3(const char* key, std::optional<Vec3> fallback = {}) const;
  Vec3 unit_vector3(const char* key, std::optional<Vec3> fallback = {}) const;
  /// From `quat_wxyz` or `rpy_deg` (about fixed x, then y, then z, as in URDF); identity when neither is
  /// there.
  Mat3 rotation() const;

  /// The table under `key` opened with its own keys; an absent one reads as an empty table.
  TomlReader table(const char* key, std::span<const char* const> keys) const;
  TomlReader table(const char* key, Keys keys) const {
    return table(key, std::span(keys.begin(), keys.size()));
  }
  /// The tables of an array of tables `[[path.key]]`, each opened with `keys`; none when absent.
  std::vector<TomlReader> tables(const char* key, Keys keys) const;

  /// An error at the value of `key`, or at the table's own place when it is absent.
  void fail(const char* key, std::string what, std::string found = "", std::string expected = "") const;
  /// "FILE:LINE:COLUMN" of a key's value, or of the table.
  std::string where(const char* key = nullptr) const;

 private:
  const toml::node* node(const char* key, bool required, const char* expected) const;
  void check_keys(std::span<const char* const> keys) const;
  std::string path_of(const char* key) const;

  const toml::table& table_;
  const std::string& file_;
  std::string path_;
  FirstError& errors_;
};

/// "FILE:LINE:COLUMN".
std::string place(const std::string& file, const toml::source_position& position);

}  // namespace tactum
