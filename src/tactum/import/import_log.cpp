#include "tactum/import/import_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace tactum::inline v0_1 {

std::string ImportNote::sentence() const { return fmt::format("{}:{}: {}", file, line, text); }

std::vector<ImportNote> ImportLog::notes() const {
  std::vector<ImportNote> sorted = notes_;
  std::stable_sort(sorted.begin(), sorted.end(), [](const ImportNote& a, const ImportNote& b) {
    return a.file != b.file ? a.file < b.file : a.line < b.line;
  });
  // What stands in several replicas is told once.
  std::set<std::string> sentences;
  std::erase_if(sorted, [&](const ImportNote& note) { return !sentences.insert(note.sentence()).second; });
  return sorted;
}

void ImportLog::fail(const XmlElement& at, std::string what, std::string found, std::string expected) {
  errors_.add({std::move(what), std::move(found), std::move(expected), place_of(at)});
}

void ImportLog::fail(const XmlElement& at, const XmlAttribute& attribute, std::string what, std::string found,
                     std::string expected) {
  errors_.add({std::move(what), std::move(found), std::move(expected), place_of(at, attribute)});
}

void ImportLog::note(const XmlElement& at, std::string text) {
  notes_.push_back({at.file, at.line, std::move(text)});
}

void ImportLog::note_unread(const XmlElement& element) {
  if (!element.read) {
    notes_.push_back({element.file, element.line,
                      fmt::format("<{}> is not honoured{}", element.name,
                                  element.children.empty() ? "" : ", nor what it holds")});
    return;
  }
  for (const XmlAttribute& attribute : element.attributes)
    if (!attribute.read)
      notes_.push_back({element.file, attribute.line,
                        fmt::format("\"{}\" of <{}> is not honoured", attribute.name, element.name)});
  for (const XmlElement& child : element.children) note_unread(child);
}

Attributes::Attributes(ImportLog& log, const XmlElement& element,
                       const std::vector<const XmlElement*>& defaults)
    : log_(log), layers_{&element} {
  layers_.insert(layers_.end(), defaults.begin(), defaults.end());
}

Attributes::Found Attributes::find(std::string_view name) const {
  Found found;
  for (const XmlElement* layer : layers_) {  // those behind the first are overruled, and so honoured as well
    const XmlAttribute* attribute = layer->find(name);
    if (attribute != nullptr && found.attribute == nullptr) found = {layer, attribute};
  }
  return found;
}

bool Attributes::has(std::string_view name) const { return find(name).attribute != nullptr; }

std::string Attributes::text(std::string_view name, const std::string& fallback) const {
  const Found found = find(name);
  return found.attribute != nullptr ? found.attribute->value : fallback;
}

void Attributes::fail(std::string_view name, std::string what, std::string found,
                      std::string expected) const {
  const Found at = find(name);
  if (at.attribute == nullptr)
    return log_.fail(element(), std::move(what), std::move(found), std::move(expected));
  log_.fail(*at.element, *at.attribute, std::move(what), std::move(found), std::move(expected));
}

std::vector<double> Attributes::parsed(const Found& found, std::size_t least, std::size_t most) const {
  const std::string& text = found.attribute->value;
  std::vector<double> values;
  const char* at = text.data();
  const char* const end = at + text.size();
  const auto is_space = [](char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; };
  while (true) {
    while (at != end && is_space(*at)) ++at;
    if (at == end) break;
    if (*at == '+') ++at;
    double value = 0.0;
    const auto [rest, trouble] = std::from_chars(at, end, value);
    const bool whole = trouble == std::errc() && (rest == end || is_space(*rest));
    if (!whole || !std::isfinite(value) || values.size() == most) break;
    values.push_back(value);
    at = rest;
  }
  if (at == end && values.size() >= least) return values;
  const std::string expected =
      least == most ? fmt::format("{}", least) : fmt::format("{} to {}", least, most);
  log_.fail(*found.element, *found.attribute,
            fmt::format("\"{}\" of <{}> is wrong", found.attribute->name, found.element->name),
            fmt::format("\"{}\"", text), fmt::format("{} {}", expected, most == 1 ? "number" : "numbers"));
  return std::vector<double>(least, 0.0);
}

std::vector<double> Attributes::numbers(std::string_view name, std::size_t least, std::size_t most) const {
  const Found found = find(name);
  return found.attribute != nullptr ? parsed(found, least, most) : std::vector<double>{};
}

double Attributes::number(std::string_view name, double fallback, Range range) const {
  const std::vector<double> values = numbers(name, 1, 1);
  if (values.empty()) return fallback;
  if (!within(values[0], range))
    fail(name, fmt::format("\"{}\" of <{}> is out of range", name, element().name),
         fmt::format("{}", values[0]), shown(range));
  return values[0];
}

bool Attributes::flag(std::string_view name, bool fallback) const {
  return word(name, fallback ? 1 : 0, {"false", "true"}) == 1;
}

int Attributes::word(std::string_view name, int fallback, const std::vector<std::string>& words) const {
  const Found found = find(name);
  if (found.attribute == nullptr) return fallback;
  const auto at = std::find(words.begin(), words.end(), found.attribute->value);
  if (at != words.end()) return static_cast<int>(at - words.begin());
  fail(name, fmt::format("\"{}\" of <{}> is none of its words", name, element().name),
       fmt::format("\"{}\"", found.attribute->value), one_of_meant(found.attribute->value, words));
  return fallback;
}

Vec3 Attributes::vector(std::string_view name, const Vec3& fallback) const {
  const std::vector<double> values = numbers(name, 3, 3);
  return values.empty() ? fallback : Vec3(values[0], values[1], values[2]);
}

void Attributes::overlay(std::string_view name, std::vector<double>& values) const {
  for (auto layer = layers_.rbegin(); layer != layers_.rend(); ++layer) {
    const XmlAttribute* attribute = (*layer)->find(name);
    if (attribute == nullptr) continue;
    const std::vector<double> given = parsed({*layer, attribute}, 1, values.size());
    std::copy(given.begin(), given.end(), values.begin());
  }
}

}  // namespace tactum::inline v0_1
