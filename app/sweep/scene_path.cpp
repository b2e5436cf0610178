/// Values put into the text of a scene by their paths.

#include <fmt/format.h>
#include <toml++/toml.h>

#include <charconv>
#include <optional>
#include <sstream>

#include "app/sweep/sweep_plan.h"

namespace tactum {
namespace {

/// A step of a path: a key of a table, or a place in a list by its number or by the item's name.
struct PathStep {
  std::string word;
  bool in_list = false;
};

std::optional<std::vector<PathStep>> steps_of(const std::string& path) {
  std::vector<PathStep> steps;
  std::size_t at = 0;
  while (at < path.size()) {
    const bool in_list = path[at] == '[';
    const std::size_t from = in_list ? at + 1 : at;
    const std::size_t to =
        in_list ? path.find(']', from) : std::min(path.find_first_of(".[", from), path.size());
    if (to == std::string::npos || to == from) return {};
    steps.push_back({path.substr(from, to - from), in_list});
    at = in_list ? to + 1 : to;
    if (at == path.size()) break;
    if (path[at] == '.') {
      ++at;
      if (at == path.size() || path[at] == '[') return {};
    } else if (path[at] != '[') {
      return {};
    }
  }
  if (steps.empty() || steps.front().in_list) return {};
  return steps;
}

std::optional<std::size_t> place_in(const toml::array& list, const std::string& word) {
  std::size_t place = 0;
  const char* end = word.data() + word.size();
  const auto read = std::from_chars(word.data(), end, place);
  if (read.ec == std::errc() && read.ptr == end) {
    if (place < list.size()) return place;
    return {};
  }
  for (std::size_t i = 0; i < list.size(); ++i)
    if (const toml::table* item = list[i].as_table())
      if ((*item)["name"].value<std::string>() == word) return i;
  return {};
}

template <class Put>
void put_value(const SweepValue& value, const Put& put) {
  std::visit([&](const auto& plain) { put(plain); }, value);
}

Error no_such(const std::string& path, const PathStep& step, const char* expected) {
  return {"a path of the sweep leads nowhere",
          fmt::format("\"{}\" at {}{}{}", path, step.in_list ? "[" : "", step.word, step.in_list ? "]" : ""),
          expected, ""};
}

/// The node that a step leads to from another; a table that is not there is made.
Result<toml::node*> follow(toml::node& from, const std::string& path, const PathStep& step) {
  if (step.in_list) {
    toml::array* list = from.as_array();
    if (list == nullptr) return no_such(path, step, "a list before the bracket");
    const std::optional<std::size_t> place = place_in(*list, step.word);
    if (!place) return no_such(path, step, "a place in the list, or the name of an item");
    return list->get(*place);
  }
  toml::table* table = from.as_table();
  if (table == nullptr) return no_such(path, step, "a table before the key");
  if (!table->contains(step.word)) table->insert(step.word, toml::table{});
  return table->get(step.word);
}

Result<void> set_value(toml::table& scene, const std::string& path, const SweepValue& value) {
  const std::optional<std::vector<PathStep>> steps = steps_of(path);
  if (!steps)
    return Error{"a path of the sweep cannot be read", "\"" + path + "\"",
                 "keys with dots between, as in body[peg].part.peg.width_m", ""};
  toml::node* node = &scene;
  for (std::size_t i = 0; i + 1 < steps->size(); ++i) {
    Result<toml::node*> next = follow(*node, path, (*steps)[i]);
    if (!next) return next.error();
    node = *next;
  }
  const PathStep& last = steps->back();
  if (last.in_list) {
    toml::array* list = node->as_array();
    if (list == nullptr) return no_such(path, last, "a list before the bracket");
    const std::optional<std::size_t> place = place_in(*list, last.word);
    if (!place) return no_such(path, last, "a place in the list");
    put_value(value, [&](const auto& plain) {
      list->replace(list->cbegin() + static_cast<std::ptrdiff_t>(*place), plain);
    });
    return {};
  }
  toml::table* table = node->as_table();
  if (table == nullptr) return no_such(path, last, "a table before the key");
  put_value(value, [&](const auto& plain) { table->insert_or_assign(last.word, plain); });
  return {};
}

}  // namespace

Result<std::string> with_value(const std::string& scene_text, const std::string& path,
                               const SweepValue& value) {
  try {
    toml::table scene(toml::parse(scene_text));
    if (Result<void> set = set_value(scene, path, value); !set) return set.error();
    std::ostringstream text;
    text << toml::toml_formatter(scene) << '\n';
    return text.str();
  } catch (const toml::parse_error& error) {
    return Error{"the scene of the sweep is no TOML", std::string(error.description()), "a scene file", ""};
  }
}

}  // namespace tactum
