#include "tactum/devices/number_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string_view>

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

std::vector<std::string_view> split(std::string_view line, bool commas) {
  std::vector<std::string_view> cells;
  if (commas) {
    for (std::size_t start = 0; start <= line.size();) {
      const std::size_t end = std::min(line.find(',', start), line.size());
      cells.push_back(trimmed(line.substr(start, end - start)));
      start = end + 1;
    }
    return cells;
  }
  constexpr std::string_view kBlank = " \t";
  for (std::size_t start = line.find_first_not_of(kBlank); start != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(kBlank, start), line.size());
    cells.push_back(line.substr(start, end - start));
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
  if (text.rfind("\xEF\xBB\xBF", 0) == 0) text.erase(0, 3);
  return text;
}

Result<void> read_header(std::string_view line, const std::string& where, NumberTable& table) {
  for (const std::string_view name : split(line, true)) {
    if (table.column(std::string(name)) >= 0) {
      return Error{"column named twice", quoted(name), "a name once", where};
    }
    table.columns.emplace_back(name);
  }
  return {};
}

Result<void> read_row(std::string_view line, int line_number, bool commas, NumberTable& table) {
  const std::vector<std::string_view> cells = split(line, commas);
  const std::string where = table.path + ":" + std::to_string(line_number);
  if (cells.size() != table.columns.size()) {
    return Error{"wrong number of columns", std::to_string(cells.size()),
                 std::to_string(table.columns.size()), where};
  }
  for (std::size_t i = 0; i < cells.size(); ++i) {
    bool plain = false;
    const double value = parsed(cells[i], plain);
    if (!plain || !std::isfinite(value)) {
      const std::string found = cells[i].empty() ? "an empty cell" : quoted(cells[i]);
      return Error{plain ? "not a finite number" : "not a number", found, "a finite number",
                   where + ": column " + table.columns[i]};
    }
    table.values.push_back(value);
  }
  table.lines.push_back(line_number);
  return {};
}

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
  Result<std::string> text = file_text(path);
  if (!text) return text.error();
  NumberTable table;
  table.path = path;
  bool started = false;
  bool commas = false;
  int line_number = 0;
  for (std::size_t start = 0; start < text->size();) {
    const std::size_t end = std::min(text->find('\n', start), text->size());
    const std::string_view line = trimmed(std::string_view(*text).substr(start, end - start));
    start = end + 1;
    ++line_number;
    if (line.empty() || line.front() == '#') continue;
    if (!started) {
      started = true;
      commas = line.find(',') != std::string_view::npos;
      if (commas) {
        const std::string where = path + ":" + std::to_string(line_number);
        if (Result<void> header = read_header(line, where, table); !header) return header.error();
        continue;
      }
      table.columns = names_without_header;
    }
    if (Result<void> row = read_row(line, line_number, commas, table); !row) return row.error();
  }
  if (table.rows() == 0) {
    return Error{"no row of numbers", started ? "a header only" : "an empty file", "at least one row", path};
  }
  return table;
}

}  // namespace tactum::inline v0_1
