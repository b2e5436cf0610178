#pragma once
/// The runs of a sweep that are done, kept as they end: a line a run with a checksum. A line that was cut by
/// a kill is taken off when the sweep goes on.

#include <cstdint>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/sweep/sweep_run.h"

namespace tactum {

/// A result as a line without its end, and back; nothing where it is no such line, or its checksum differs.
std::string result_line(const SweepResult& result);
std::optional<SweepResult> result_of_line(std::string_view line);

class SweepJournal {
 public:
  /// Opens the journal of a plan, or begins it. An error where it is of another plan, or another
  /// process has it open.
  static Result<SweepJournal> open(const std::string& path, const SweepPlan& plan);

  /// Writes a result through to the system, so that a kill loses none. An error where the disk is full.
  Result<void> add(const SweepResult& result);
  const std::map<std::uint64_t, SweepResult>& done() const noexcept { return done_; }
  /// The runs of the plan that are not done.
  std::vector<std::uint64_t> pending(const SweepPlan& plan) const;
  /// The sweep is over and its result is written: the journal is not needed any more.
  void remove();

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  SweepJournal(std::string path, std::FILE* file) : path_(std::move(path)), file_(file) {}
  std::string path_;
  std::unique_ptr<std::FILE, Close> file_;
  std::map<std::uint64_t, SweepResult> done_;
};

}  // namespace tactum
