#pragma once
/// Strict reading of TOML tables: every key a table may have is listed when it is opened, anything else in it
/// is an error that names the nearest known key; every value has a type and a range. Errors give file, line
/// and column.
///
///   const TomlReader hand = scene.table("hand", {"grip", "tremor", "step"});
///   const std::string grip = hand.text("grip", "medium");
///   if (errors) ...                                   the first error is kept, later ones are not
///
/// A reader given a wrong value stores the first error and goes on with the fallback, so that a section reads
/// as a list of its keys. For src/tactum/scene/*.cpp only: it shows toml++, which the layer uses privately.

#include <toml++/toml.h>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tactum/math/pose.h"
#include "tactum/scene/item_errors.h"

namespace tactum::inline v0_1 {

class TomlReader {
 public:
  using Keys = std::initializer_list<const char*>;

  /// `path` is the table's (item_path), empty for the whole file; `file` names the source. All references
  /// must outlive the reader.
  TomlReader(const toml::table& table, const std::string& file, std::string path,
             std::span<const char* const> keys, FirstError& errors);
  TomlReader(const toml::table& table, const std::string& file, std::string path, Keys keys,
             FirstError& errors)
      : TomlReader(table, file, std::move(path), std::span(keys.begin(), keys.size()), errors) {}

  bool has(const char* key) const { return table_.contains(key); }
  bool is_array(const char* key) const {
    const toml::node* value = table_.get(key);
    return value != nullptr && value->is_array();
  }
  /// "[body 2.joint]", or "the file" for the whole.
  std::string section() const { return path_.empty() ? "the file" : file_section(path_); }
  FirstError& errors() const { return errors_; }

  // With a fallback a key may be absent; without one it must be there.
  /// `reason` follows the range in the error of a number that is out of it.
  double number(const char* key, std::optional<double> fallback = {}, Range range = kAny,
                std::string_view reason = "") const;
  int integer(const char* key, std::optional<int> fallback, int low, int high) const;
  bool flag(const char* key, bool fallback) const;
  std::string text(const char* key, std::optional<std::string> fallback = {}) const;
  /// A text that must be one of `choices`.
  std::string choice(const char* key, std::optional<std::string> fallback,
                     const std::vector<std::string>& choices) const;
  std::vector<double> numbers(const char* key, std::size_t count) const;
  Vec3 vector3(const char* key, std::optional<Vec3> fallback = {}) const;
  /// From `quat_wxyz` or `rpy_deg` (about fixed x, then y, then z, as in URDF); identity when neither is
  /// there.
  Mat3 rotation() const;

  /// The table under `key` opened with its own keys; an absent one reads as an empty table.
  TomlReader table(const char* key, std::span<const char* const> keys) const;
  TomlReader table(const char* key, Keys keys) const {
    return table(key, std::span(keys.begin(), keys.size()));
  }
  /// The number of tables in the array of tables `[[path.key]]`; 0 when absent.
  std::size_t size(const char* key) const;
  /// One of them, counted from 0, opened with its own keys.
  TomlReader element(const char* key, std::size_t index, std::span<const char* const> keys) const;

  /// An error at the value of `key`, or at the table's own place when it is absent.
  void fail(const char* key, std::string what, std::string found = "", std::string expected = "") const;
  /// Of a key's value, or of the table where it is null or absent.
  toml::source_position position(const char* key = nullptr) const;
  /// As in item_path.
  const std::string& path() const { return path_; }

 private:
  const toml::node* node(const char* key, bool required, const char* expected) const;
  void check_keys(std::span<const char* const> keys) const;

  const toml::table& table_;
  const std::string& file_;
  std::string path_;
  FirstError& errors_;
};

/// "FILE:LINE:COLUMN".
std::string place(const std::string& file, const toml::source_position& position);

}  // namespace tactum::inline v0_1
