#include "tactum/devices/number_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string_view>

#include "tactum/base/text_encoding.h"

namespace tactum::inline v0_1 {
namespace {

constexpr std::uintmax_t kMaxFileBytes = 1ull << 30;  // days of motion at 1 kHz; more is a wrong file
constexpr std::size_t kMaxQuoted = 40;                // characters of a bad cell shown in an error

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

/// What separates the cells of a line; a blank stands for any number of blanks and tabs.
struct Separator {
  char character = ',';
  const char* name = "commas";
};
constexpr Separator kComma = {',', "commas"};
constexpr Separator kSemicolon = {';', "semicolons"};
constexpr Separator kTab = {'\t', "tabs"};
constexpr Separator kBlanks = {' ', "blanks"};

std::string_view unquoted(std::string_view cell) {
  const bool is_quoted = cell.size() >= 2 && cell.front() == '"' && cell.back() == '"';
  return is_quoted ? cell.substr(1, cell.size() - 2) : cell;
}

std::vector<std::string_view> split(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  if (separator != kBlanks.character) {
    for (std::size_t start = 0; start <= line.size();) {
      const std::size_t end = std::min(line.find(separator, start), line.size());
      cells.push_back(unquoted(trimmed(line.substr(start, end - start))));
      start = end + 1;
    }
    return cells;
  }
  constexpr std::string_view kBlank = " \t";
  for (std::size_t start = line.find_first_not_of(kBlank); start != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(kBlank, start), line.size());
    cells.push_back(unquoted(line.substr(start, end - start)));
    start = line.find_first_not_of(kBlank, end);
  }
  return cells;
}

std::string quoted(std::string_view text) {
  std::string shown;
  for (const char c : text.substr(0, kMaxQuoted)) shown += c >= ' ' && c <= '~' ? c : '?';
  return "'" + shown + (text.size() > kMaxQuoted ? "...'" : "'");
}

/// The number, or NaN when the cell is none; `plain` is set to whether it was a number at all.
double parsed(std::string_view cell, bool& plain) {
  if (!cell.empty() && cell.front() == '+') cell.remove_prefix(1);
  double value = std::nan("");
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  plain = error == std::errc{} && end == cell.data() + cell.size();
  return value;
}

bool is_number(std::string_view cell) {
  bool plain = false;
  parsed(cell, plain);
  return plain;
}

Result<std::string> file_text(const std::string& path) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) return Error{"cannot read the file", error.message(), "", path};
  if (size > kMaxFileBytes) {
    return Error{"the file is too large", std::to_string(size) + " bytes", "at most 1 GiB", path};
  }
  std::ifstream file(path, std::ios::binary);
  std::string text(size, '\0');
  if (!file.read(text.data(), static_cast<std::streamsize>(size))) {
    return Error{"cannot read the file", "a read error", "", path};
  }
  const Result<std::string_view> plain = utf8_text(text, path);
  if (!plain) return plain.error();
  text.erase(0, text.size() - plain->size());
  // A line may end with CR alone; with CR LF the blank line between them is passed over.
  if (text.find('\n') == std::string::npos) std::replace(text.begin(), text.end(), '\r', '\n');
  return text;
}

/// Reads one table, line by line.
class TableReader {
 public:
  TableReader(const std::string& path, const std::vector<std::string>& names_without_header)
      : names_without_header_(names_without_header) {
    table_.path = path;
  }

  Result<NumberTable> read(std::string_view text) {
    for (std::size_t start = 0; start < text.size();) {
      const std::size_t end = std::min(text.find('\n', start), text.size());
      const std::string_view line = trimmed(text.substr(start, end - start));
      start = end + 1;
      ++line_number_;
      if (line.empty() || line.front() == '#' || names_separator(line)) continue;
      const bool is_first = table_.columns.empty();
      if (is_first) {
        if (Result<void> header = read_header(line); !header) return header.error();
      }
      if (is_first && has_header_) continue;
      if (Result<void> row = read_row(line); !row) return row.error();
    }
    if (table_.rows() == 0) {
      return Error{"no row of numbers", table_.columns.empty() ? "an empty file" : "a header only",
                   "at least one row", table_.path};
    }
    return std::move(table_);
  }

 private:
  /// Whether the line is "sep=;", with which a spreadsheet names the separator above the header.
  static bool names_separator(std::string_view line) {
    return line.size() <= 5 && (line.starts_with("sep=") || line.starts_with("SEP="));
  }

  /// Finds the separator and the names of the columns.
  Result<void> read_header(std::string_view line) {
    const auto commas = std::count(line.begin(), line.end(), ',');
    const auto semicolons = std::count(line.begin(), line.end(), ';');
    const bool has_tab = line.find('\t') != std::string_view::npos;
    separator_ = commas > semicolons ? kComma : semicolons > 0 ? kSemicolon : has_tab ? kTab : kBlanks;
    const std::vector<std::string_view> names = split(line, separator_.character);
    has_header_ = std::none_of(names.begin(), names.end(), is_number);
    if (!has_header_) {
      const bool between_blanks =
          separator_.character == kTab.character || separator_.character == kBlanks.character;
      if (!between_blanks || names_without_header_.empty()) {
        return Error{"the table has no header", quoted(line), "a line with the names of the columns",
                     where()};
      }
      separator_ = kBlanks;
      table_.columns = names_without_header_;
      return {};
    }
    for (const std::string_view name : names) {
      if (table_.column(std::string(name)) >= 0)
        return Error{"column named twice", quoted(name), "a name once", where()};
      table_.columns.emplace_back(name);
    }
    return {};
  }

  Result<void> read_row(std::string_view line) {
    const std::vector<std::string_view> cells = split(line, separator_.character);
    if (cells.size() != table_.columns.size()) {
      std::string expected = std::to_string(table_.columns.size());
      if (cells.size() == 1) expected += std::string(" separated by ") + separator_.name;
      return Error{"wrong number of columns", std::to_string(cells.size()), expected, where()};
    }
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const Result<double> value = number(cells[i], i);
      if (!value) return value.error();
      table_.values.push_back(*value);
    }
    table_.lines.push_back(line_number_);
    return {};
  }

  /// The cell of a column as a finite number, with a decimal point or, where commas do not separate, a
  /// decimal comma.
  Result<double> number(std::string_view cell, std::size_t column) {
    const auto commas = std::count(cell.begin(), cell.end(), ',');
    const bool has_point = cell.find('.') != std::string_view::npos;
    has_decimal_comma_ = has_decimal_comma_ || commas > 0;
    has_decimal_point_ = has_decimal_point_ || has_point;
    const auto place = [&] { return where() + ": column " + table_.columns[column]; };
    if (commas > 1 || (has_decimal_comma_ && has_decimal_point_)) {
      return Error{
          std::string("the decimal mark of a table separated by ") + separator_.name + " is not clear",
          quoted(cell), "a comma or a point before the decimals, the same in every cell", place()};
    }
    bool plain = false;
    double value = 0.0;
    if (commas == 1) {
      std::string with_point(cell);
      with_point[cell.find(',')] = '.';
      value = parsed(with_point, plain);
    } else {
      value = parsed(cell, plain);
    }
    if (plain && std::isfinite(value)) return value;
    const std::string found = cell.empty() ? "an empty cell" : quoted(cell);
    return Error{plain ? "not a finite number" : "not a number", found, "a finite number", place()};
  }

  std::string where() const { return table_.path + ":" + std::to_string(line_number_); }

  const std::vector<std::string>& names_without_header_;
  NumberTable table_;
  Separator separator_;
  int line_number_ = 0;
  bool has_header_ = false;
  bool has_decimal_comma_ = false;
  bool has_decimal_point_ = false;
};

}  // namespace

int NumberTable::column(const std::string& name) const {
  const auto found = std::find(columns.begin(), columns.end(), name);
  return found == columns.end() ? -1 : static_cast<int>(found - columns.begin());
}

std::string NumberTable::where(std::size_t row) const { return path + ":" + std::to_string(lines[row]); }

std::string NumberTable::where(std::size_t row, std::size_t column) const {
  return where(row) + ": column " + columns[column];
}

Result<NumberTable> read_number_table(const std::string& path,
                                      const std::vector<std::string>& names_without_header) {
  const Result<std::string> text = file_text(path);
  if (!text) return text.error();
  return TableReader(path, names_without_header).read(*text);
}

}  // namespace tactum::inline v0_1
