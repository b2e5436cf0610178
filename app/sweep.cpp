/// tactum sweep FILE.toml: a scene or recording over a grid of parameters, on all cores.

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <mutex>

#include "app/report/sweep_page.h"
#include "app/sweep/sweep_job.h"
#include "app/sweep/sweep_table.h"
#include "commands.h"
#include "tactum/base/parallel.h"
#include "watch.h"

namespace tactum {
namespace {

struct SweepCommand {
  SweepOptions options;
  int threads = 0;
};

/// Whether this is one of several processes that mpirun, or a scheduler of a cluster, has started.
bool started_by_mpi() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK"})
    if (std::getenv(name) != nullptr) return true;
  return false;
}

/// Becomes the program that is linked with MPI.
[[noreturn]] void become_mpi_program(const SweepOptions& options) {
  const std::filesystem::path own = std::filesystem::read_symlink("/proc/self/exe");
  const std::string program = (own.parent_path() / "tactum-sweep-mpi").string();
  std::vector<std::string> words = {program, options.file};
  if (!options.out.empty()) words.insert(words.end(), {"--out", options.out});
  if (!options.page.empty()) words.insert(words.end(), {"--page", options.page});
  if (options.anew) words.emplace_back("--anew");
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  execv(program.c_str(), arguments.data());
  fail({"a sweep over MPI needs a program that is built where MPI is installed", "no tactum-sweep-mpi",
        "libopenmpi-dev, and a new build", program});
}

/// Computes what is left on some threads. False when it was interrupted.
bool compute_on_threads(SweepJob& job, int threads) {
  const std::vector<std::uint64_t> pending = job.journal.pending(job.plan);
  SweepProgress progress(job.journal.done().size(), job.plan.runs());
  std::mutex mutex;
  std::optional<Error> trouble;
  std::atomic<bool> stops{false};
  for_ranges(threads, pending.size(), 1, [&](std::size_t i, std::size_t) {
    if (stops.load() || interrupted()) return;
    const SweepResult result = run_of_sweep(job.plan, pending[i]);
    const std::lock_guard lock(mutex);
    if (const Result<void> kept = job.journal.add(result); !kept) {
      trouble = kept.error();
      stops.store(true);
    }
    progress.show(job.journal.done().size());
  });
  if (trouble) fail(*trouble);
  return job.journal.done().size() == job.plan.runs();
}

void sweep(const SweepCommand& command) {
  if (started_by_mpi()) become_mpi_program(command.options);
  Result<SweepPlan> plan = read_sweep(command.options.file);
  if (!plan) fail(plan.error());
  Result<SweepJob> job = open_job(std::move(*plan), command.options);
  if (!job) fail(job.error());
  const std::size_t before = job->journal.done().size();
  if (before > 0) fmt::print(stderr, "{} of {} runs were done before\n", before, job->plan.runs());
  watch_for_interrupts();
  if (!compute_on_threads(*job, command.threads > 0 ? command.threads : all_cores()))
    fail({"the sweep was interrupted",
          fmt::format("{} of {} runs", job->journal.done().size(), job->plan.runs()),
          "the same command again, which goes on from there", command.options.file});
  if (const Result<void> written = finish_job(*job); !written) fail(written.error());
  if (!job->page.empty()) write_text(job->page, sweep_page(job->plan, job->journal.done()));
  for (const auto& [run, result] : job->journal.done())
    if (!result.error.empty()) fmt::print(stderr, "run {} could not be computed: {}\n", run, result.error);
  fmt::print("{}, in {}\n", sentence_on(job->journal.done()), job->out);
}

}  // namespace

void add_sweep(CLI::App& app) {
  auto options = std::make_shared<SweepCommand>();
  CLI::App* command =
      app.add_subcommand("sweep", "Run a scene or a recording over a grid of parameters, on all cores");
  command->footer(
      "A sweep that was killed or interrupted goes on where it was when the command is given again. Over "
      "MPI: "
      "mpirun -n 8 tactum sweep FILE.toml. Exit codes: 0 done, 1 an error, 2 the command line is wrong.");
  command->add_option("FILE", options->options.file, "The sweep, a TOML file (docs/sweep.md)")->required();
  command->add_option("-o,--out", options->options.out,
                      "The HDF5 file of the results; by default the sweep's name with .h5, in this folder");
  command->add_option("--page", options->options.page,
                      "Write a page with maps of success, time, peak force and jams over the first two axes");
  command->add_option("--threads", options->threads, "How many threads compute; by default one a core")
      ->check(whole_number_between(1, 1024, "a number of threads"));
  command->add_flag("--anew", options->options.anew, "Compute again what there is of the result");
  command->callback([options] { sweep(*options); });
}

}  // namespace tactum
