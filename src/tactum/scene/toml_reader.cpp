#include "tactum/scene/toml_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tactum/base/tolerances.h"
#include "tactum/scene/scene_description.h"

namespace tactum::inline v0_1 {
namespace {

const toml::table kEmptyTable;

/// A value as it is quoted in an error.
std::string shown(const toml::node& node) {
  if (const auto* text = node.as_string()) return fmt::format("\"{}\"", text->get());
  if (const auto* number = node.as_integer()) return fmt::format("{}", number->get());
  if (const auto* number = node.as_floating_point()) return fmt::format("{}", number->get());
  if (const auto* flag = node.as_boolean()) return flag->get() ? "true" : "false";
  if (const auto* array = node.as_array()) return fmt::format("an array of {}", array->size());
  if (node.is_table()) return "a table";
  return "a date or time";
}

/// "body.component" of "body[1].component".
std::string table_name(const std::string& path) {
  std::string name;
  bool inside = false;
  for (const char c : path) {
    if (c == '[') inside = true;
    if (!inside) name += c;
    if (c == ']') inside = false;
  }
  return name;
}

}  // namespace

std::string place(const std::string& file, const toml::source_position& position) {
  return fmt::format("{}:{}:{}", file, position.line, position.column);
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
    const std::string nearest = meant_word(key.str(), known);
    errors_.add({"unknown key in " + section(), fmt::format("\"{}\"", key.str()),
                 nearest.empty() ? one_of(known) : fmt::format("\"{}\"", nearest),
                 place(file_, key.source().begin)});
  }
}

toml::source_position TomlReader::position(const char* key) const {
  const toml::node* value = key ? table_.get(key) : nullptr;
  return (value ? value->source() : table_.source()).begin;
}

void TomlReader::fail(const char* key, std::string what, std::string found, std::string expected) const {
  errors_.add({std::move(what), std::move(found), std::move(expected), place(file_, position(key))});
}

const toml::node* TomlReader::node(const char* key, bool required, const char* expected) const {
  const toml::node* value = table_.get(key);
  if (!value && required)
    fail(nullptr, fmt::format("missing key \"{}\" in {}", key, section()), "none", expected);
  return value;
}

double TomlReader::number(const char* key, std::optional<double> fallback, Range range,
                          std::string_view reason) const {
  const double otherwise = fallback.value_or(0.0);
  const toml::node* value = node(key, !fallback, "a number");
  if (!value) return otherwise;
  if (!value->is_number()) {
    fail(key, fmt::format("wrong type of \"{}\" in {}", key, section()), shown(*value), "a number");
    return otherwise;
  }
  const double read = *value->value<double>();
  if (within(read, range)) return read;
  fail(key, fmt::format("\"{}\" in {} is out of range", key, section()), shown(*value),
       shown(range) + std::string(reason));
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
  fail(key, fmt::format("\"{}\" in {} is not known", key, section()), shown(*value),
       one_of_meant(read, choices));
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
  return rotation_rpy_deg(vector3("rpy_deg", Vec3::Zero()));
}

TomlReader TomlReader::table(const char* key, std::span<const char* const> keys) const {
  const toml::node* value = table_.get(key);
  const toml::table* inner = value ? value->as_table() : nullptr;
  if (value && !inner)
    fail(key, fmt::format("wrong type of \"{}\" in {}", key, section()), shown(*value),
         value->is_array_of_tables()
             ? fmt::format("a table, [{}] with one bracket", table_name(item_path(path_, key)))
             : "a table");
  return {inner ? *inner : kEmptyTable, file_, item_path(path_, key), keys, errors_};
}

std::size_t TomlReader::size(const char* key) const {
  const toml::node* value = table_.get(key);
  if (!value) return 0;
  const auto* array = value->as_array();
  if (!array) {
    fail(key, fmt::format("wrong type of \"{}\" in {}", key, section()), shown(*value),
         value->is_table()
             ? fmt::format("an array of tables, [[{}]] with two brackets", table_name(item_path(path_, key)))
             : "an array of tables");
    return 0;
  }
  for (const toml::node& item : *array)
    if (!item.is_table())
      errors_.add({fmt::format("wrong value in \"{}\" in {}", key, section()), shown(item), "a table",
                   place(file_, item.source().begin)});
  return array->size();
}

TomlReader TomlReader::element(const char* key, std::size_t index, std::span<const char* const> keys) const {
  const toml::table* inner = table_.get(key)->as_array()->get(index)->as_table();
  return {inner ? *inner : kEmptyTable, file_, item_path(path_, key, index), keys, errors_};
}

}  // namespace tactum::inline v0_1
