/// tactum-bench surfaces: all minima of two surfaces, beside FCL's distance and Bullet's GImpact on the same
/// poses. What is measured, and how, is in bench/surfaces.h.

#include <fmt/format.h>

#include <cstdlib>
#include <memory>

#include "bench/main/commands.h"
#include "bench/surfaces.h"

namespace tactum {
namespace {

struct SurfacesJob {
  bench::SurfacesOptions options;
  std::string json, markdown;
};

void run_surfaces(const SurfacesJob& job) {
  const bench::SurfacesReport report =
      bench_surfaces(job.options, [](const std::string& what) { fmt::print(stderr, "{}\n", what); });
  const bench::Table table = table_of(report);
  if (job.json != "-") fmt::print("{}\n{}\n", table.text(), report.how);
  if (!job.json.empty()) {
    nlohmann::ordered_json json = nlohmann::ordered_json::array();
    for (const bench::SurfacesRow& row : report.rows) json.push_back(to_json(row));
    write_json(job.json, json);
  }
  if (!job.markdown.empty() &&
      !bench::write_between_marks(job.markdown, "surfaces", table.markdown() + "\n" + report.how + "\n"))
    fail({"cannot write the file", "", "", job.markdown});
}

}  // namespace

void add_bench_surfaces(CLI::App& parent) {
  auto job = std::make_shared<SurfacesJob>();
  CLI::App* command =
      parent.add_subcommand("surfaces", "All minima of two triangle surfaces, beside FCL and Bullet");
  if (const char* data = std::getenv("TACTUM_DATA")) job->options.data = data;
  command->add_option("--data", job->options.data,
                      "folder of real meshes and motions (default: TACTUM_DATA)");
  command->add_option("--pairs", job->options.pairs, "by name, with commas")
      ->delimiter(',')
      ->check(CLI::IsMember(bench::surface_pair_names()));
  command->add_option("--frames", job->options.frames, "poses of each motion made here")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  command->add_option("--replays", job->options.replays, "each pose counts with its fastest replay")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--peer-seconds", job->options.peer_budget_s, "time for each peer on each pair")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_flag("--quick", job->options.quick, "few poses: does everything work?");
  command->add_option("--json", job->json, "write a row a pair to this file (- for standard output, alone)");
  command->add_option(
      "--markdown", job->markdown,
      "write the table to this file, between its marks when it has them (docs/benchmarks.md)");
  command->callback([job] { run_surfaces(*job); });
}

}  // namespace tactum
