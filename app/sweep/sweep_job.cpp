#include "app/sweep/sweep_job.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>

#include "app/sweep/sweep_table.h"

namespace tactum {

Result<SweepJob> open_job(SweepPlan plan, const SweepOptions& options) {
  namespace fs = std::filesystem;
  std::string out = options.out.empty() ? fs::path(options.file).stem().string() + ".h5" : options.out;
  const std::string journal_path = out + ".runs";
  std::error_code ignored;
  if (options.anew) {
    fs::remove(out, ignored);
    fs::remove(journal_path, ignored);
  }
  if (fs::exists(out, ignored))
    return Error{"the result is there already", "a file", "another --out, or --anew to compute it again",
                 out};
  Result<SweepJournal> journal = SweepJournal::open(journal_path, plan);
  if (!journal) return journal.error();
  return SweepJob{std::move(plan), std::move(out), options.page, std::move(*journal)};
}

Result<void> finish_job(SweepJob& job) {
  if (Result<void> written = write_sweep(job.plan, job.journal.done(), job.out); !written) return written;
  job.journal.remove();
  return {};
}

SweepProgress::SweepProgress(std::uint64_t done, std::uint64_t all)
    : first_(done),
      all_(all),
      on_terminal_(isatty(STDERR_FILENO) != 0),
      start_(std::chrono::steady_clock::now()) {}

SweepProgress::~SweepProgress() {
  if (shown_) fmt::print(stderr, "\n");
}

void SweepProgress::show(std::uint64_t done) {
  if (!on_terminal_) return;
  shown_ = true;
  constexpr std::size_t kBar = 40;
  const std::size_t full = all_ == 0 ? kBar : static_cast<std::size_t>(done * kBar / all_);
  const double gone_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  const double left_s =
      done > first_ ? gone_s * static_cast<double>(all_ - done) / static_cast<double>(done - first_) : 0.0;
  fmt::print(stderr, "\r[{}{}] {} of {} runs, {:.0f} s left   ", std::string(full, '#'),
             std::string(kBar - full, ' '), done, all_, left_s);
  std::fflush(stderr);
}

}  // namespace tactum
