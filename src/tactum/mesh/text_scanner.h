#pragma once
/// Lines and tokens of a text that is already in memory, as views: nothing is copied, the locale plays no
/// part.

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>
#include <type_traits>

namespace tactum::inline v0_1::detail {

inline bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f';
}

/// The text line by line; a line ends with LF, CR LF or a lone CR.
class LineReader {
 public:
  /// With `continued`, a backslash at the end joins the next line, as OBJ allows.
  explicit LineReader(std::string_view text, bool continued = false, int first_number = 1)
      : text_(text), continued_(continued), line_number_(first_number - 1), next_number_(first_number) {}

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
  int line_number() const { return line_number_; }    ///< of the line last given
  std::size_t position() const { return position_; }  ///< bytes behind the line last given

 private:
  std::string_view text_;
  bool continued_;
  std::size_t position_ = 0;
  int line_number_;
  int next_number_;
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
  std::size_t size() const { return rest_.size(); }  ///< bytes not given yet
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

/// The words of a text one after the other, whatever lines they stand in.
class WordReader {
 public:
  /// The text begins in this line of its file.
  explicit WordReader(std::string_view text, int first_number = 1) : lines_(text, false, first_number) {}

  /// The next word; empty at the end of the text.
  std::string_view next() {
    std::string_view word = line_.next();
    for (std::string_view line; word.empty() && lines_.next(line);) {
      line_ = Tokens(line);
      word = line_.next();
    }
    return word;
  }
  /// The next word of the same line; empty at its end.
  std::string_view next_in_line() { return line_.next(); }
  void skip_line() { line_ = Tokens(std::string_view()); }
  int line_number() const { return lines_.line_number(); }  ///< of the word last given
  /// Bytes up to its end, and at most a line end more.
  std::size_t position() const { return lines_.position() - line_.size(); }

 private:
  LineReader lines_;
  Tokens line_{std::string_view()};
};

/// Whether a word of a file is this one, which is in small letters, in letters of any case.
inline bool same_word(std::string_view word, std::string_view small) {
  const auto same = [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; };
  return std::equal(word.begin(), word.end(), small.begin(), small.end(), same);
}

/// The whole word as a number (a leading plus is allowed); false when it is none or out of the type's range.
template <class T>
bool parse_number(std::string_view word, T& value) {
  if (word.size() > 1 && word.front() == '+' && word[1] != '-') word.remove_prefix(1);
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc{} && end == word.data() + word.size() && !word.empty()) return true;
  if constexpr (std::is_floating_point_v<T>) {  // Fortran's exponent: 1.5D+02
    constexpr std::size_t kLongest = 64;
    const std::size_t d = word.find_first_of("dD");
    if (d == std::string_view::npos || d == 0 || word.size() > kLongest) return false;
    std::array<char, kLongest> text{};
    std::copy(word.begin(), word.end(), text.begin());
    text[d] = 'e';
    const auto [stop, trouble] = std::from_chars(text.data(), text.data() + word.size(), value);
    return trouble == std::errc{} && stop == text.data() + word.size();
  }
  return false;
}

}  // namespace tactum::inline v0_1::detail
