#pragma once
/// A recording as a table: one row a frame, the columns of a trace (telemetry/trace.h) with every body. The
/// head, in lines that begin with '#', tells the run, its settings, and the meaning of each column.

#include <cstdio>
#include <string>

#include "tactum/recording/mcap_reader.h"

namespace tactum::inline v0_1 {

struct CsvExport {
  std::uint64_t rows = 0;
  McapEnd end;  ///< how the recording ended
};

/// Writes to `out`. An error where there is nothing to be told, or `out` does not take it. `name` is the
/// recording's, for errors. Numbers have as many digits as their bits need.
Result<CsvExport> export_csv(const McapSource& source, const std::string& name, std::FILE* out);

}  // namespace tactum::inline v0_1
