#pragma once
/// Lines and tokens of a text that is already in memory, as views: nothing is copied, the locale plays no
/// part.

#include <charconv>
#include <string_view>

namespace tactum::inline v0_1::detail {

inline bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f';
}

/// The text line by line; a line ends with LF, CR LF or a lone CR.
class LineReader {
 public:
  /// With `continued`, a backslash at the end joins the next line, as OBJ allows.
  explicit LineReader(std::string_view text, bool continued = false) : text_(text), continued_(continued) {}

  bool next(std::string_view& line) {
    if (position_ >= text_.size()) return false;
    const std::size_t start = position_;
    line_number_ = next_number_;
    std::size_t end = text_.find_first_of("\r\n", position_);
    while (end != std::string_view::npos) {
      ++next_number_;
      position_ = end + (text_.substr(end, 2) == "\r\n" ? 2 : 1);
      if (!continued_ || end == start || text_[end - 1] != '\\') break;
      end = text_.find_first_of("\r\n", position_);
    }
    if (end == std::string_view::npos) position_ = end = text_.size();
    line = text_.substr(start, end - start);
    return true;
  }
  int line_number() const { return line_number_; }    ///< of the line last given; the first is 1
  std::size_t position() const { return position_; }  ///< bytes behind the line last given
  std::string_view rest() const { return text_.substr(position_); }

 private:
  std::string_view text_;
  bool continued_;
  std::size_t position_ = 0;
  int line_number_ = 0;
  int next_number_ = 1;
};

/// The blank-separated words of a line. A backslash before a line end counts as blank.
class Tokens {
 public:
  explicit Tokens(std::string_view line) : rest_(line) {}

  /// The next word; empty at the end.
  std::string_view next() {
    std::size_t start = 0;
    while (start < rest_.size() && (is_blank(rest_[start]) || is_joint(start))) ++start;
    std::size_t end = start;
    while (end < rest_.size() && !is_blank(rest_[end]) && !is_joint(end)) ++end;
    const std::string_view word = rest_.substr(start, end - start);
    rest_.remove_prefix(end);
    return word;
  }
  /// The rest of the line, without blanks at either end.
  std::string_view remainder() const {
    std::string_view text = rest_;
    while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
    while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
    return text;
  }

 private:
  bool is_joint(std::size_t i) const {
    return rest_[i] == '\\' && i + 1 < rest_.size() && (rest_[i + 1] == '\n' || rest_[i + 1] == '\r');
  }
  std::string_view rest_;
};

/// The whole word as a number (a leading plus is allowed); false when it is none or out of the type's range.
template <class T>
bool parse_number(std::string_view word, T& value) {
  if (word.size() > 1 && word.front() == '+' && word[1] != '-') word.remove_prefix(1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc{} && end == word.data() + word.size() && !word.empty();
}

}  // namespace tactum::inline v0_1::detail
