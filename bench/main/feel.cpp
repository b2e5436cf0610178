/// tactum-bench feel: what is felt against analytic truth, beside rigid-body engines. What is measured, and
/// how, is in bench/feel.h.

#include <fmt/format.h>

#include "bench/feel.h"
#include "bench/main/commands.h"
#include "bench/pairs_plot.h"

namespace tactum {
namespace {

struct FeelJob {
  bench::FeelOptions options;
  bool alone = false;
  std::string json, markdown, svg;
};

void put(const std::string& path, const std::string& name, const bench::Table& table) {
  if (!bench::write_between_marks(path, name, table.markdown()))
    fail({"cannot write the file", "", "", path});
}

void run_feel(FeelJob& job) {
  job.options.peers = !job.alone;
  const bench::FeelReport report =
      bench_feel(job.options, [](const std::string& what) { fmt::print(stderr, "{}\n", what); });
  const bench::Table truths = table_of(report.rows), pegs = table_of(report.pegs);
  if (job.json != "-") {
    if (!report.rows.empty()) fmt::print("{}\n", truths.text());
    if (!report.pegs.empty()) fmt::print("{}", pegs.text());
  }
  if (!job.json.empty()) {
    nlohmann::ordered_json json = nlohmann::ordered_json::array();
    for (const bench::FeelRow& row : report.rows) json.push_back(to_json(row));
    for (const bench::PegRow& row : report.pegs) json.push_back(to_json(row));
    write_json(job.json, json);
  }
  if (!job.markdown.empty()) {
    put(job.markdown, "feel", truths);
    put(job.markdown, "feel pegs", pegs);
  }
  if (!job.svg.empty() && !bench::write_text(job.svg, bench::peg_plot(report.pegs)))
    fail({"cannot write the file", "", "", job.svg});
}

}  // namespace

void add_bench_feel(CLI::App& parent) {
  auto job = std::make_shared<FeelJob>();
  CLI::App* command = parent.add_subcommand(
      "feel", "What is felt against analytic truth, beside rigid-body engines with a virtual coupling");
  std::vector<std::string> names;
  for (const bench::FeelSceneEntry& scene : bench::feel_scenes()) names.push_back(scene.name);
  command->add_option("--scenes", job->options.scenes, "by name, with commas")
      ->delimiter(',')
      ->check(CLI::IsMember(names));
  command->add_option("--hands", job->options.hands, "that lead each peg; 0: no pegs")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
  command->add_flag("--alone", job->alone, "without the other engines");
  command->add_option("--json", job->json, "write the rows to this file (- for standard output, alone)");
  command->add_option("--markdown", job->markdown,
                      "write the tables to this file, between its marks (docs/benchmarks.md)");
  command->add_option("--svg", job->svg, "draw the pegs into this file");
  command->callback([job] { run_feel(*job); });
}

}  // namespace tactum
