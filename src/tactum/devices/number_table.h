#pragma once
/// A text file of numbers in columns: separated by commas, semicolons or tabs with a header, or by blanks
/// with or without one. Strict: every row has every column, every cell is a finite number, and errors give
/// file, line and column. Line ends of any system, blank lines, '#' comments, a byte order mark, names in
/// double quotes and scientific notation are fine. Where no comma separates, "0,5" is one half, unless other
/// cells of the table have a decimal point.

#include <span>
#include <string>
#include <vector>

#include "tactum/base/result.h"

namespace tactum::inline v0_1 {

struct NumberTable {
  std::string path;
  std::vector<std::string> columns;  ///< names, from the header or from the caller
  std::vector<int> lines;            ///< line in the file of every row, from 1
  std::vector<double> values;        ///< rows one after the other

  std::size_t rows() const { return lines.size(); }
  std::span<const double> row(std::size_t i) const {
    return std::span(values).subspan(i * columns.size(), columns.size());
  }
  /// Index of a column, or -1.
  int column(const std::string& name) const;
  /// "FILE:LINE", and with a column "FILE:LINE: column NAME".
  std::string where(std::size_t row) const;
  std::string where(std::size_t row, std::size_t column) const;
};

/// The first line that is neither blank nor a comment is the header, unless it is numbers between blanks:
/// then these are named by `names_without_header`. At least one row.
Result<NumberTable> read_number_table(const std::string& path,
                                      const std::vector<std::string>& names_without_header);

}  // namespace tactum::inline v0_1
