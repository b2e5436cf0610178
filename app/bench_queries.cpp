/// tactum bench pairs: the contact queries of one pair of convex pieces, beside those of other libraries on
/// the same poses. What is measured, and how, is in bench/.

#include <fmt/format.h>

#include "bench/pairs.h"
#include "bench/report.h"
#include "bench_commands.h"
#include "output.h"

namespace tactum {
namespace {

/// Where the results go.
struct Outputs {
  std::string json, markdown, svg;
};

void add_outputs(CLI::App& command, Outputs& outputs) {
  command.add_option("--json", outputs.json,
                     "write a row a measurement to this file (- for standard output, alone)");
  command.add_option(
      "--markdown", outputs.markdown,
      "write the tables to this file, between its marks when it has them (docs/benchmarks.md)");
}

void write_markdown(const std::string& path, const std::string& mark, const std::string& text) {
  if (!path.empty() && !bench::write_between_marks(path, mark, text))
    fail({"cannot write the file", "", "", path});
}

nlohmann::ordered_json rows_json(const std::vector<bench::Row>& rows) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const bench::Row& row : rows) json.push_back(to_json(row));
  return json;
}

void tell_progress(const std::string& what) { fmt::print(stderr, "{}\n", what); }

struct PairsCommand {
  bench::PairsOptions options;
  Outputs outputs;

  void run() const {
    const bench::PairsReport report = bench_pairs(options, tell_progress);
    const std::string how = fmt::format("{}\nDistances proved by the referee: {} of {} poses.\n", report.how,
                                        report.proved, report.recorded);
    if (outputs.json != "-")
      fmt::print("{}\n* the fastest peer that answers every query, right to 1 um\n\n{}\n{}",
                 every_row(report.rows).text(), against_peers(report.rows).text(), how);
    if (!outputs.json.empty()) write_json(outputs.json, rows_json(report.rows));
    write_markdown(outputs.markdown, "pairs", against_peers(report.rows).markdown() + "\n" + how);
  }
};

std::vector<std::string> regime_names() {
  std::vector<std::string> names;
  for (const bench::Regime& regime : bench::regimes()) names.push_back(regime.name);
  return names;
}

}  // namespace

void add_bench_pairs(CLI::App& bench) {
  auto job = std::make_shared<PairsCommand>();
  CLI::App* command = bench.add_subcommand(
      "pairs", "Distance queries of pairs of convex pieces, beside FCL, libccd, Bullet and ODE");
  bench::PairsOptions& options = job->options;
  command->add_option("--shapes", options.shapes, "pairs by name, with commas")
      ->delimiter(',')
      ->check(CLI::IsMember(bench::names_of(bench::distance_pairs())));
  command->add_option("--regimes", options.regimes, "with commas")
      ->delimiter(',')
      ->check(CLI::IsMember(regime_names()));
  command->add_option("--engines", options.engines, "with commas")
      ->delimiter(',')
      ->check(CLI::IsMember(bench::engine_names()));
  command->add_option("--frames", options.frames, "poses of each recording")
      ->check(CLI::Range(100, 10000000))
      ->capture_default_str();
  command->add_option("--replays", options.replays, "each pose counts with its fastest replay")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command
      ->add_option("--peer-seconds", options.peer_budget_s,
                   "time for each peer on each recording; slow ones answer fewer poses of it")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_flag("--quick", options.quick, "a look whether everything works: two pairs, few poses");
  add_outputs(*command, job->outputs);
  command->callback([job] { job->run(); });
}

}  // namespace tactum
