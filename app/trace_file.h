#pragma once
/// Writes the trace of a run (telemetry/trace.h) as CSV, for tactum feel --trace.

#include <cstdio>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "tactum/session/session.h"

namespace tactum {

class TraceFile {
 public:
  /// Opens the file, and writes the head: comment lines that begin with '#' (scene, device, settings, frames,
  /// date), then the names of the columns. Fails with a sentence where that cannot be. From here on the
  /// session's frames are traced; it must outlive this.
  /// The rows have the bodies where `bodies` or `passes_on` says so; the file has them for `bodies` alone.
  TraceFile(const std::string& path, Session& session, std::uint64_t frames, bool bodies,
            bool passes_on = false);
  ~TraceFile();
  TraceFile(const TraceFile&) = delete;
  TraceFile& operator=(const TraceFile&) = delete;

  /// Writes what the frames have left since the last call; at least once in FrameTrace::kFrames frames.
  void drain();
  /// Writes the rest. Fails with a sentence when the disk did not take all of it.
  void finish();

  /// Who is given every row as it is drained; an empty function for nobody.
  void pass_rows_to(std::function<void(std::span<const double>)> other) { other_ = std::move(other); }
  const FrameTrace& rows_of_frames() const { return trace_; }

  std::uint64_t rows() const { return rows_; }
  std::uint64_t lost() const { return trace_.dropped(); }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::string path_;
  Session& session_;
  FrameTrace trace_;
  std::size_t columns_;  // of the file; the rows may have more
  std::vector<double> row_;
  std::function<void(std::span<const double>)> other_;
  std::uint64_t rows_ = 0;
  std::unique_ptr<std::FILE, Close> file_;
};

}  // namespace tactum
