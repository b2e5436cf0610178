#pragma once
/// Tables of measurements: aligned for the terminal, and as Markdown for docs/benchmarks.md.

#include <string>
#include <vector>

#include "bench/measure.h"

namespace tactum::bench {

/// Cells by row, the first row the heading. Columns after the first `left` are aligned to the right.
struct Table {
  std::vector<std::vector<std::string>> rows;
  std::size_t left = 1;
  std::string text() const;
  std::string markdown() const;
};

/// A line an engine, pair and regime: times, error, ratio to ours; the fastest accurate peer is marked.
Table every_row(const std::vector<Row>& rows);

/// A line a pair and regime: ours, the fastest accurate peer, and how many times faster ours is.
Table against_peers(const std::vector<Row>& rows);

/// A line an engine and pair of overlapping pieces: times, and how often the depth is not the smallest.
Table depth_rows(const std::vector<Row>& rows);

/// A line a pair: ours, and the peer whose depth is least often not the smallest (of equals, the fastest).
Table depths_against_peers(const std::vector<Row>& rows);

/// "0.12 µm", "-": lengths from nanometres to millimetres.
std::string length_text(double length_m);
/// "47 ns", "1.25 µs", "3.4 ms".
std::string time_text(double time_ns);

/// Puts `text` between the lines `<!-- NAME -->` and `<!-- end NAME -->` of the file; a file without them
/// becomes the text alone. False when it cannot be written.
bool write_between_marks(const std::string& path, const std::string& name, const std::string& text);

}  // namespace tactum::bench
