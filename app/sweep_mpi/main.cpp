/// tactum sweep over MPI:  mpirun -n 8 tactum sweep FILE.toml  becomes this program.
///
///   rank 0, thread 1    hands out runs, keeps the journal, shows a bar <--- results ---  ranks 1, 2 ...
///   rank 0, thread 2    computes as they do                             --- numbers --->
///
/// A rank asks for its next run with the result of its last one. So no rank waits for another, and the result
/// does not depend on who computed what.

#include <fmt/format.h>
#include <mpi.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <chrono>
#include <mutex>
#include <thread>

#include "app/manual.h"
#include "app/report/sweep_page.h"
#include "app/sweep/sweep_job.h"
#include "app/sweep/sweep_table.h"
#include "tactum/mesh/mapped_file.h"

namespace tactum {
namespace {

constexpr int kResultTag = 1, kRunTag = 2;
constexpr long long kNoMore = -1;

/// Hands out the runs that are left, and keeps what comes back.
class Dispatcher {
 public:
  explicit Dispatcher(SweepJob& job)
      : job_(job),
        pending_(job.journal.pending(job.plan)),
        progress_(job.journal.done().size(), job.plan.runs()) {}

  long long next() {
    const std::lock_guard lock(mutex_);
    return at_ < pending_.size() && !trouble_ ? static_cast<long long>(pending_[at_++]) : kNoMore;
  }
  void keep(const SweepResult& result) {
    const std::lock_guard lock(mutex_);
    if (const Result<void> kept = job_.journal.add(result); !kept && !trouble_) trouble_ = kept.error();
  }
  void show() {
    const std::lock_guard lock(mutex_);
    progress_.show(job_.journal.done().size());
  }
  /// Why results could not be kept; for when all ranks are done.
  const std::optional<Error>& trouble() const { return trouble_; }

 private:
  SweepJob& job_;
  std::vector<std::uint64_t> pending_;
  std::size_t at_ = 0;
  std::mutex mutex_;
  std::optional<Error> trouble_;
  SweepProgress progress_;
};

/// Answers the ranks that ask, until each knows that there is no more.
void serve(Dispatcher& dispatcher, int ranks) {
  int at_work = ranks - 1;
  while (at_work > 0) {
    int any = 0;
    MPI_Status status;
    MPI_Iprobe(MPI_ANY_SOURCE, kResultTag, MPI_COMM_WORLD, &any, &status);
    if (any == 0) {  // a probe that waits would keep a core from computing
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      continue;
    }
    int size = 0;
    MPI_Get_count(&status, MPI_CHAR, &size);
    std::string line(static_cast<std::size_t>(size), '\0');
    MPI_Recv(line.data(), size, MPI_CHAR, status.MPI_SOURCE, kResultTag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    if (const std::optional<SweepResult> result = result_of_line(line)) dispatcher.keep(*result);
    const long long run = dispatcher.next();
    MPI_Send(&run, 1, MPI_LONG_LONG, status.MPI_SOURCE, kRunTag, MPI_COMM_WORLD);
    if (run == kNoMore) --at_work;
    dispatcher.show();
  }
}

void compute_for_others(const SweepPlan& plan) {
  std::string line;
  while (true) {
    long long run = kNoMore;
    MPI_Send(line.data(), static_cast<int>(line.size()), MPI_CHAR, 0, kResultTag, MPI_COMM_WORLD);
    MPI_Recv(&run, 1, MPI_LONG_LONG, 0, kRunTag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    if (run == kNoMore) return;
    line = result_line(run_of_sweep(plan, static_cast<std::uint64_t>(run)));
  }
}

Result<void> compute_and_serve(SweepJob& job, int ranks) {
  Dispatcher dispatcher(job);
  std::thread computing([&] {
    for (long long run = dispatcher.next(); run != kNoMore; run = dispatcher.next())
      dispatcher.keep(run_of_sweep(job.plan, static_cast<std::uint64_t>(run)));
  });
  serve(dispatcher, ranks);
  computing.join();
  dispatcher.show();
  if (dispatcher.trouble()) return *dispatcher.trouble();
  if (Result<void> written = finish_job(job); !written) return written;
  return job.page.empty() ? Result<void>()
                          : write_whole_file(job.page, sweep_page(job.plan, job.journal.done()));
}

/// Whether all ranks have read the same plan.
Result<void> agree(const Result<SweepPlan>& plan) {
  unsigned long long hash = plan ? plan->hash : 0;
  MPI_Bcast(&hash, 1, MPI_UNSIGNED_LONG_LONG, 0, MPI_COMM_WORLD);
  const int same = plan && plan->hash == hash ? 1 : 0;
  int all = 0;
  MPI_Allreduce(&same, &all, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
  if (!plan) return plan.error();
  if (all == 1) return {};
  return Error{"the ranks read different sweeps", "", "the same files on every machine", plan->file};
}

Result<void> sweep_over_mpi(const SweepOptions& options, int rank, int ranks) {
  Result<SweepPlan> plan = read_sweep(options.file);
  if (const Result<void> agreed = agree(plan); !agreed) return agreed;
  int opened = 0;
  if (rank != 0) {
    MPI_Bcast(&opened, 1, MPI_INT, 0, MPI_COMM_WORLD);
    if (opened == 1) compute_for_others(*plan);
    return {};
  }
  Result<SweepJob> job = open_job(std::move(*plan), options);
  opened = job ? 1 : 0;
  MPI_Bcast(&opened, 1, MPI_INT, 0, MPI_COMM_WORLD);
  if (!job) return job.error();
  const Result<void> done = compute_and_serve(*job, ranks);
  if (done) fmt::print("{}, in {}\n", sentence_on(job->journal.done()), job->out);
  return done;
}

}  // namespace
}  // namespace tactum

int main(int argc, char** argv) {
  using namespace tactum;
  SweepOptions options;
  CLI::App app("tactum sweep over MPI: one rank a core.", "tactum-sweep-mpi");
  app.add_option("FILE", options.file, "The sweep")->required();
  app.add_option("-o,--out", options.out, "The result");
  app.add_option("--page", options.page, "A page with maps of the result");
  app.add_flag("--anew", options.anew, "Compute everything again");
  if (print_manual(app, argc, argv)) return 0;
  int provided = 0, rank = 0, ranks = 1;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  int code = 0;
  try {
    app.parse(argc, argv);
    const Result<void> done = sweep_over_mpi(options, rank, ranks);
    if (!done && rank == 0) fmt::print(stderr, "tactum: {}\n", done.error().message());
    code = done ? 0 : 1;
  } catch (const CLI::ParseError& error) {
    code = error.get_exit_code() == 0 ? 0 : 2;  // 0: --help
    if (rank == 0 && code == 0) app.exit(error);
    if (rank == 0 && code != 0) fmt::print(stderr, "tactum: {}\n", error.what());
  }
  MPI_Finalize();
  return code;
}
