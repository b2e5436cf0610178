#include "tactum/scene/toml_slips.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>

#include "tactum/scene/toml_reader.h"

namespace tactum::inline v0_1 {
namespace {

/// Tables of which a scene file has several.
constexpr std::array kTableArrays{"body",     "body.component", "body.field_point", "field",
                                  "friction", "restitution",    "hand.step",        "goal"};

std::string trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return "";
  return std::string(text.substr(first, text.find_last_not_of(" \t\r") + 1 - first));
}

/// A line of the file.
struct SourceLine {
  std::string text;               ///< without spaces around it
  std::string code;               ///< the same, with the insides of texts and the comment left out
  std::optional<char> open_text;  ///< the quote of a text that does not end in the line
};

SourceLine source_line(std::string_view line) {
  SourceLine made{trimmed(line), "", {}};
  for (std::size_t i = 0; i < made.text.size(); ++i) {
    const char c = made.text[i];
    if (made.open_text == '"' && c == '\\') {
      ++i;
    } else if (made.open_text) {
      if (c == *made.open_text) made.open_text.reset();
      if (!made.open_text) made.code += c;
    } else if (c == '#') {
      break;
    } else {
      if (c == '"' || c == '\'') made.open_text = c;
      made.code += c;
    }
  }
  made.code = trimmed(made.code);
  return made;
}

/// The fault and the place that a rule looks at.
struct Fault {
  std::string_view text;    ///< of the whole file
  std::string description;  ///< the parser's
  int number = 1;           ///< of the line
  SourceLine line;
  char at = '\n';  ///< the character at the place; the end of a line beyond it

  bool says(std::string_view words) const { return description.find(words) != std::string::npos; }
};

/// One line of the file, counted from 1; empty beyond its end.
std::string_view line_of(std::string_view text, int number) {
  for (int i = 1; i < number; ++i) {
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos) return {};
    text.remove_prefix(end + 1);
  }
  return text.substr(0, text.find('\n'));
}

using Slip = std::optional<Error>;

Slip slip(std::string what, std::string found, std::string expected) {
  return Error{"not TOML: " + std::move(what), std::move(found), std::move(expected), ""};
}

Slip other_format(const Fault& fault) {
  if (fault.says("utf-8"))
    return slip("this is no plain text", "bytes that are not UTF-8", "a text in UTF-8");
  const std::size_t first = std::min(fault.text.find_first_not_of(" \t\r\n"), fault.text.size());
  const std::string_view rest = fault.text.substr(first);
  const std::string start = trimmed(rest.substr(0, rest.find('\n')));
  const char* format = nullptr;
  if (start.starts_with("<")) format = "XML, as URDF, SDF and MJCF are";
  if (start.starts_with("{") || start.starts_with("[{")) format = "JSON";
  if (start.starts_with("---") || start.starts_with("%YAML") || start.starts_with("- ")) format = "YAML";
  if (format == nullptr) return {};
  constexpr std::size_t kMostShown = 60;
  return slip(fmt::format("this is {}", format), fmt::format("\"{}\"", start.substr(0, kMostShown)),
              "lines such as schema = 1, see docs/scene-format.md");
}

Slip colon_for_equals(const Fault& fault) {
  const std::string& code = fault.line.code;
  const std::size_t colon = code.find(':');
  if (!fault.says("'='") || colon == std::string::npos || colon > code.find('=')) return {};
  std::string key = trimmed(fault.line.text.substr(0, fault.line.text.find(':')));
  std::erase_if(key, [](char c) { return c == '"' || c == '\'' || c == ' '; });
  if (key.starts_with("-")) key.erase(0, 1);
  return slip("a colon after a key, as YAML and JSON have it", fmt::format("\"{}:\"", key), key + " = ...");
}

Slip text_without_end(const Fault& fault) {
  const SourceLine& line = fault.line;
  if (!line.open_text) return {};
  const char quote = *line.open_text;
  const std::size_t opening = line.text.find(quote);
  const std::string value = trimmed(line.text.substr(line.text.find('=') + 1));
  if (value.empty() || value.front() != quote) {
    if (std::count(line.text.begin(), line.text.end(), quote) == 1 && line.text.ends_with(quote) &&
        std::isalpha(static_cast<unsigned char>(value.empty() ? '0' : value.front())))
      return slip("a text has no opening quote", value, quote + value);
  }
  const std::string open =
      line.text.substr(line.text.rfind(quote) == opening ? opening : line.text.rfind(quote));
  return slip("a text has no closing quote", open, fmt::format("a {} at its end", quote));
}

/// "body" of "[[body]"; empty where the line is no header.
std::string header_name(const std::string& code) {
  if (!code.starts_with("[")) return "";
  std::string name = code;
  std::erase_if(name, [](char c) { return c == '[' || c == ']' || c == ' '; });
  return name;
}

Slip header(const Fault& fault) {
  const std::string& code = fault.line.code;
  const std::string name = header_name(code);
  if (name.empty()) return {};
  const bool several = std::find(kTableArrays.begin(), kTableArrays.end(), name) != kTableArrays.end();
  if (fault.says("cannot redefine") && several)
    return slip(fmt::format("[{}] has one bracket", name), code,
                fmt::format("[[{0}]] with two brackets, for each {0}", name));
  if (fault.says("cannot redefine"))
    return slip(fmt::format("[{}] is there twice", name), code,
                fmt::format("one [{}] with all its keys", name));
  if (fault.says("']'"))
    return slip("the brackets of a heading do not match", code,
                fmt::format("{0}{2}{1}", several ? "[[" : "[", several ? "]]" : "]", name));
  return {};
}

Slip key_twice(const Fault& fault) {
  if (!fault.says("cannot redefine")) return {};
  const std::string key = trimmed(fault.line.text.substr(0, fault.line.text.find('=')));
  return slip(fmt::format("\"{}\" is there twice in one table", key), fault.line.code, "it once");
}

Slip typographic_quotes(const Fault& fault) {
  for (const char* quote : {"\u201c", "\u201d", "\u201e", "\u2018", "\u2019", "\u00ab"})
    if (fault.line.code.find(quote) != std::string::npos)
      return slip("typographic quotes", quote, "the plain quote \"");
  return {};
}

Slip comment(const Fault& fault) {
  for (const char* mark : {"//", "/*", ";", "%"})
    if (fault.line.code.starts_with(mark)) return slip("a comment begins with #", mark, "#");
  return {};
}

/// A bracket that an earlier line, or this one, has opened and that is still open where the next key begins.
Slip open_bracket(const Fault& fault) {
  std::string open;
  int opened_in = fault.number;
  int first = fault.number;
  constexpr int kMostLines = 200;  // that a bracket stays open, in what people write
  while (first > 1 && fault.number - first < kMostLines &&
         line_of(fault.text, first - 1).find('=') == std::string_view::npos)
    --first;
  if (first > 1) --first;
  for (int n = first; n <= fault.number; ++n) {
    const std::string code = source_line(line_of(fault.text, n)).code;
    if (header_name(code) != "" && open.empty()) continue;
    for (const char c : code) {
      if (c == '[' || c == '{') {
        if (open.empty()) opened_in = n;
        open += c;
      }
      if ((c == ']' || c == '}') && !open.empty()) open.pop_back();
    }
  }
  if (open.empty()) return {};
  const char closing = open.back() == '[' ? ']' : '}';
  return slip(fmt::format("a {} has no closing {}", open.back(), closing),
              source_line(line_of(fault.text, opened_in)).text, fmt::format("{} at its end", closing));
}

Slip comma(const Fault& fault) {
  if (fault.says("dangling comma")) return slip("a comma before }", fault.line.text, "none there");
  const bool list = fault.says("expected comma or closing");
  if (list && (std::isalnum(static_cast<unsigned char>(fault.at)) ||
               std::string_view("-+.\"'{[").find(fault.at) != std::string_view::npos))
    return slip("a comma is missing", fault.line.text, "a comma between the items, as in [0, 0, 1]");
  if (!fault.says("comment or whitespace") || fault.at != ',') return {};
  const std::string value = trimmed(fault.line.code.substr(fault.line.code.find('=') + 1));
  if (value.ends_with(",") && std::count(value.begin(), value.end(), ',') == 1)
    return slip("a comma at the end of a line", value, "none there");
  return slip("several numbers stand in brackets", value, fmt::format("[{}]", value));
}

Slip behind_value(const Fault& fault) {
  if (!fault.says("comment or whitespace")) return {};
  if (fault.at == ']' || fault.at == '}')
    return slip("a closing bracket too many", fault.line.text, fmt::format("one {} less", fault.at));
  const std::string value = trimmed(fault.line.code.substr(fault.line.code.find('=') + 1));
  return slip("more than a value behind the =", value,
              "the value alone: units stand in the names of keys, and each key in a line of its own");
}

Slip value(const Fault& fault) {
  const std::string written = trimmed(fault.line.code.substr(fault.line.code.find('=') + 1));
  if (fault.says("expected value")) return slip("a key has no value", fault.line.text, "one behind the =");
  if (fault.says("floating-point"))
    return slip("a number needs digits on both sides of its point", written, "0.5 or 5.0");
  if (written.starts_with("=")) return slip("two equals signs", fault.line.text, "one");
  if (!fault.says("could not determine") && !fault.says("boolean")) return {};
  std::string lower = written;
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (lower == "true" || lower == "false") return slip("true and false are written small", written, lower);
  return slip("a text stands in quotes", written, "as in name = \"block\"");
}

Slip no_equals(const Fault& fault) {
  if (!fault.says("'='")) return {};
  return slip("a key without =", fault.line.text, "a line such as name = \"block\"");
}

}  // namespace

Error toml_error(std::string_view text, const std::string& file, const toml::parse_error& error) {
  const toml::source_position at = error.source().begin;
  const int number = static_cast<int>(at.line);
  const std::string_view line = line_of(text, number);
  const std::size_t column = at.column > 0 ? at.column - 1 : 0;
  const Fault fault{text, std::string(error.description()), number, source_line(line),
                    column < line.size() ? line[column] : '\n'};
  for (const auto rule : {other_format, typographic_quotes, text_without_end, colon_for_equals, header,
                          key_twice, comment, open_bracket, comma, behind_value, value, no_equals}) {
    Slip meant = rule(fault);
    if (!meant) continue;
    meant->where = place(file, at);
    return std::move(*meant);
  }
  return Error{"not TOML", fault.description, "", place(file, at)};
}

}  // namespace tactum::inline v0_1
