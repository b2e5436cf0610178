#include "tactum/scene/toml_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "tactum/base/tolerances.h"

namespace tactum {
namespace {

const toml::table kEmptyTable;

/// A value as the reader of an error knows it.
std::string shown(const toml::node& node) {
  if (const auto* text = node.as_string()) return fmt::format("\"{}\"", text->get());
  if (const auto* number = node.as_integer()) return fmt::format("{}", number->get());
  if (const auto* number = node.as_floating_point()) return fmt::format("{}", number->get());
  if (const auto* flag = node.as_boolean()) return flag->get() ? "true" : "false";
  if (const auto* array = node.as_array()) return fmt::format("an array of {}", array->size());
  if (node.is_table()) return "a table";
  return "a date or time";
}

std::string shown(Range range) {
  if (std::isinf(range.high) && std::isinf(range.low)) return "a finite number";
  if (std::isinf(range.high))
    return fmt::format("{} {}", range.above_low ? "more than" : "at least", range.low);
  return fmt::format("{} to {}", range.low, range.high);
}

bool within(double number, Range range) {
  return std::isfinite(number) && number <= range.high &&
         (range.above_low ? number > range.low : number >= range.low);
}

/// Optimal string alignment distance: insertions, deletions, substitutions, swaps of neighbours.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
  for (std::size_t k = 0; k <= b.size(); ++k) d[0][k] = k;
  for (std::size_t i = 1; i <= a.size(); ++i)
    for (std::size_t k = 1; k <= b.size(); ++k) {
      const std::size_t change = a[i - 1] == b[k - 1] ? 0 : 1;
      d[i][k] = std::min({d[i - 1][k] + 1, d[i][k - 1] + 1, d[i - 1][k - 1] + change});
      if (i > 1 && k > 1 && a[i - 1] == b[k - 2] && a[i - 2] == b[k - 1])
        d[i][k] = std::min(d[i][k], d[i - 2][k - 2] + 1);
    }
  return d[a.size()][b.size()];
}

std::string one_of(const std::vector<std::string>& words) {
  if (words.empty()) return "nothing";
  return fmt::format("{}\"{}\"", words.size() == 1 ? "" : "one of ", fmt::join(words, "\", \""));
}

}  // namespace

std::string place(const std::string& file, const toml::source_position& position) {
  return fmt::format("{}:{}:{}", file, position.line, position.column);
}

std::string nearest_word(std::string_view word, const std::vector<std::string>& known) {
  std::string nearest;
  std::size_t least = std::max<std::size_t>(2, word.size() / 2) + 1;
  for (const std::string& candidate : known) {
    std::size_t distance = edit_distance(word, candidate);
    // "stiffness" is near "stiffness_N_per_m": a forgotten unit is the commonest slip.
    if (word.size() >= 3 && candidate.starts_with(word)) distance = std::min<std::size_t>(distance, 1);
    if (distance < least) {
      least = distance;
      nearest = candidate;
    }
  }
  return nearest;
}

TomlReader::TomlReader(const toml::table& table, const std::string& file, std::string path,
                       std::span<const char* const> keys, FirstError& errors)
    : table_(table), file_(file), path_(std::move(path)), errors_(errors) {
  check_keys(keys);
}

void TomlReader::check_keys(std::span<const char* const> keys) const {
  const std::vector<std::string> known(keys.begin(), keys.end());
  for (const auto& [key, value] : table_) {
    if (std::find(known.begin(), known.end(), key.str()) != known.end()) continue;
    const std::string nearest = nearest_word(key.str(), known);
    errors_.add({"unknown key in " + section(), fmt::format("\"{}\"", key.str()),
                 nearest.empty() ? one_of(known) : fmt::format("\"{}\"", nearest),
                 place(file_, key.source().begin)});
  }
}

std::string TomlReader::where(const char* key) const {
  const toml::node* value = key ? table_.get(key) : nullptr;
  return place(file_, (value ? value->source() : table_.source()).begin);
}

void TomlReader::fail(const char* key, std::string what, std::string found, std::string expected) const {
  errors_.add({std::move(what), std::move(found), std::move(expected), where(key)});
}

const toml::node* TomlReader::node(const char* key, bool required, const char* expected) const {
  const toml::node* value = table_.get(key);
  if (!value && required)
    fail(nullptr, fmt::format("missing key \"{}\" in {}", key, section()), "none", expected);
  return value;
}

double TomlReader::number(const char* key, std::optional<double> fallback, Range range) const {
  const double otherwise = fallback.value_or(0.0);
  const toml::node* value = node(key, !fallback, "a number");
  if (!value) return otherwise;
  if (!value->is_number()) {
    fail(key, fmt::format("wrong type of \"{}\" in {}", key, section()), shown(*value), "a number");
    return otherwise;
  }
  const double read = *value->value<double>();
  if (within(read, range)) return read;
  fail(key, fmt::format("\"{}\" in {} is out of range", key, section()), shown(*value), shown(range));
  return otherwise;
}

int TomlReader::integer(const char* key, std::optional<int> fallback, int low, int high) const {
  const int otherwise = fallback.value_or(low);
  const toml::node* value = node(key, !fallback, "a whole number");
  if (!value) return otherwise;
  const auto* read = value->as_integer();
  if (!read) {
    fail(key, fmt::format("wrong type of \"{}\" in {}", key, section()), shown(*value), "a whole number");
    return otherwise;
  }
  if (read->get() >= low && read->get() <= high) return static_cast<int>(read->get());
  fail(key, fmt::format("\"{}\" in {} is out of range", key, section()), shown(*value),
       fmt::format("{} to {}", low, high));
  return otherwise;
}

bool TomlReader::flag(const char* key, bool fallback) const {
  const toml::node* value = node(key, false, "true or false");
  if (!value) return fallback;
  if (const auto* read = value->as_boolean()) return read->get();
  fail(key, fmt::format("wrong type of \"{}\" in {}", key, section()), shown(*value), "true or false");
  return fallback;
}

std::string TomlReader::text(const char* key, std::optional<std::string> fallback) const {
  const toml::node* value = node(key, !fallback, "a text");
  if (!value) return fallback.value_or("");
  if (const auto* read = value->as_string()) return read->get();
  fail(key, fmt::format("wrong type of \"{}\" in {}", key, section()), shown(*value), "a text");
  return fallback.value_or("");
}

std::string TomlReader::choice(const char* key, std::optional<std::string> fallback,
                               const std::vector<std::string>& choices) const {
  const std::string otherwise = fallback.value_or(choices.front());
  const toml::node* value = node(key, !fallback, one_of(choices).c_str());
  if (!value) return otherwise;
  const std::string read = text(key, otherwise);
  if (std::find(choices.begin(), choices.end(), read) != choices.end()) return read;
  fail(key, fmt::format("\"{}\" in {} is not known", key, section()), shown(*value), one_of(choices));
  return otherwise;
}

std::vector<double> TomlReader::numbers(const char* key, std::size_t count) const {
  const toml::node* value = table_.get(key);
  const auto* array = value->as_array();
  const std::string expected = fmt::format("{} numbers", count);
  if (!array || array->size() != count) {
    fail(key, fmt::format("wrong type of \"{}\" in {}", key, section()), shown(*value), expected);
    return {};
  }
  std::vector<double> read;
  for (const toml::node& item : *array) {
    const std::optional<double> number = item.is_number() ? item.value<double>() : std::nullopt;
    if (!number || !std::isfinite(*number)) {
      errors_.add({fmt::format("wrong value in \"{}\" in {}", key, section()), shown(item), "a finite number",
                   place(file_, item.source().begin)});
      return {};
    }
    read.push_back(*number);
  }
  return read;
}

Vec3 TomlReader::vector3(const char* key, std::optional<Vec3> fallback) const {
  const Vec3 otherwise = fallback.value_or(Vec3::Zero());
  if (!node(key, !fallback, "3 numbers")) return otherwise;
  const std::vector<double> read = numbers(key, 3);
  return read.empty() ? otherwise : Vec3(read[0], read[1], read[2]);
}

Vec3 TomlReader::unit_vector3(const char* key, std::optional<Vec3> fallback) const {
  const Vec3 read = vector3(key, fallback);
  const double length = read.norm();
  if (length > 0.0) return read / length;
  if (has(key))
    fail(key, fmt::format("\"{}\" in {} has no direction", key, section()), "a vector of length 0",
         "an axis");
  return Vec3::UnitZ();
}

Mat3 TomlReader::rotation() const {
  if (has("quat_wxyz") && has("rpy_deg")) {
    fail("rpy_deg", "two orientations in " + section(), "quat_wxyz and rpy_deg", "one of them");
    return Mat3::Identity();
  }
  if (has("quat_wxyz")) {
    const std::vector<double> q = numbers("quat_wxyz", 4);
    if (q.empty()) return Mat3::Identity();
    const Quat quat(q[0], q[1], q[2], q[3]);
    if (std::abs(quat.norm() - 1.0) > tolerances::kQuaternionNear) {
      fail("quat_wxyz", "the quaternion in " + section() + " is no rotation",
           fmt::format("length {:.6g}", quat.norm()), "length 1");
      return Mat3::Identity();
    }
    return quat.normalized().toRotationMatrix();
  }
  const Vec3 rpy = vector3("rpy_deg", Vec3::Zero()) * (kPi / 180.0);
  const Eigen::AngleAxisd roll(rpy.x(), Vec3::UnitX());
  const Eigen::AngleAxisd pitch(rpy.y(), Vec3::UnitY());
  const Eigen::AngleAxisd yaw(rpy.z(), Vec3::UnitZ());
  return (yaw * pitch * roll).toRotationMatrix();
}

std::string TomlReader::path_of(const char* key) const { return path_.empty() ? key : path_ + "." + key; }

TomlReader TomlReader::table(const char* key, std::span<const char* const> keys) const {
  const toml::node* value = table_.get(key);
  const toml::table* inner = value ? value->as_table() : nullptr;
  if (value && !inner)
    fail(key, fmt::format("wrong type of \"{}\" in {}", key, section()), shown(*value), "a table");
  return {inner ? *inner : kEmptyTable, file_, path_of(key), keys, errors_};
}

std::vector<TomlReader> TomlReader::tables(const char* key, Keys keys) const {
  std::vector<TomlReader> readers;
  const toml::node* value = table_.get(key);
  if (!value) return readers;
  const auto* array = value->as_array();
  if (!array) {
    fail(key, fmt::format("wrong type of \"{}\" in {}", key, section()), shown(*value), "an array of tables");
    return readers;
  }
  for (const toml::node& item : *array) {
    if (const auto* inner = item.as_table()) {
      readers.emplace_back(*inner, file_, fmt::format("{} {}", path_of(key), readers.size() + 1), keys,
                           errors_);
    } else {
      errors_.add({fmt::format("wrong value in \"{}\" in {}", key, section()), shown(item), "a table",
                   place(file_, item.source().begin)});
    }
  }
  return readers;
}

}  // namespace tactum
