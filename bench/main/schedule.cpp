/// tactum-bench schedule: what a work budget costs when more pairs are near than a frame may check. What is
/// measured, and how, is in bench/schedule.h.

#include <fmt/format.h>

#include "bench/main/commands.h"
#include "bench/pairs_plot.h"
#include "bench/schedule.h"

namespace tactum {
namespace {

struct ScheduleJob {
  bench::ScheduleOptions options;
  std::string json, markdown;
};

void put(const std::string& path, const std::string& name, const std::string& text) {
  if (!bench::write_between_marks(path, name, text)) fail({"cannot write the file", "", "", path});
}

void run_schedule(const ScheduleJob& job) {
  const Result<bench::ScheduleReport> report =
      bench_schedule(job.options, [](const std::string& what) { fmt::print(stderr, "{}\n", what); });
  if (!report) fail(report.error());
  const bench::Table budgets = table_of(report->rows), heaps = table_of(report->heaps);
  const std::string model = describe(*report);
  if (job.json != "-") fmt::print("{}\n{}\n{}", budgets.text(), heaps.text(), model);
  if (!job.json.empty()) write_json(job.json, to_json(*report));
  if (!job.markdown.empty()) {
    put(job.markdown, "schedule", budgets.markdown());
    put(job.markdown, "schedule model", heaps.markdown() + "\n" + model);
  }
}

}  // namespace

void add_bench_schedule(CLI::App& parent) {
  auto job = std::make_shared<ScheduleJob>();
  CLI::App* command = parent.add_subcommand("schedule",
                                            "A heap of bodies with fewer tests a frame than pairs: error of "
                                            "the force, unchecked pairs, time of a frame");
  command->add_option("--bodies", job->options.bodies, "that fall")
      ->check(CLI::Range(1, 400))
      ->capture_default_str();
  command->add_option("--seconds", job->options.seconds, "of the hand's motion; 0: all of it")
      ->check(CLI::Range(0.0, 60.0));
  command->add_option("--shares", job->options.shares, "of the pairs, with commas")
      ->delimiter(',')
      ->check(CLI::Range(0.001, 10.0));
  command->add_option("--replays", job->options.replays, "of each frame, for the model")
      ->check(CLI::Range(1, 20));
  command->add_option("--json", job->json, "write the rows to this file (- for standard output, alone)");
  command->add_option("--markdown", job->markdown,
                      "write the tables to this file, between its marks (docs/benchmarks.md)");
  command->callback([job] { run_schedule(*job); });
}

}  // namespace tactum
