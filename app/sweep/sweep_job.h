#pragma once
/// A sweep with its files: what `tactum sweep` does on one machine and over MPI alike.

#include <chrono>
#include <string>

#include "app/sweep/sweep_journal.h"

namespace tactum {

struct SweepOptions {
  std::string file;   ///< the sweep
  std::string out;    ///< the result; empty: the sweep's name with .h5, in the folder of the command
  std::string page;   ///< maps of the result as a page; empty: none
  bool anew = false;  ///< what is there of the result is computed again
};

struct SweepJob {
  SweepPlan plan;
  std::string out, page;
  SweepJournal journal;
};

/// Opens the journal of a plan, and takes over the runs that are done. An error where the result is there
/// already.
Result<SweepJob> open_job(SweepPlan plan, const SweepOptions& options);

/// Writes the result, once all runs are done, and removes the journal.
Result<void> finish_job(SweepJob& job);

/// A bar on the terminal, overwritten in place; elsewhere nothing is printed.
class SweepProgress {
 public:
  SweepProgress(std::uint64_t done, std::uint64_t all);
  ~SweepProgress();
  void show(std::uint64_t done);

 private:
  std::uint64_t first_, all_;
  bool on_terminal_, shown_ = false;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace tactum
