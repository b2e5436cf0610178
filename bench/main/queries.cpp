/// tactum-bench pairs, penetration, manifold, impact: the contact queries of one pair of convex pieces, the
/// first two beside those of other libraries on the same poses. What is measured, and how, is in bench/.

#include <fmt/format.h>

#include "bench/impact.h"
#include "bench/main/commands.h"
#include "bench/manifold.h"
#include "bench/pairs.h"
#include "bench/pairs_plot.h"
#include "bench/report.h"

namespace tactum {
namespace {

/// What is asked for, and where the results go.
struct QueryJob {
  bench::PairsOptions options;
  std::string json, markdown, svg;
};

void report_progress(const std::string& what) { fmt::print(stderr, "{}\n", what); }

/// The tables for people, the rows for machines; `mark` names the place in the Markdown page.
template <class Rows>
void put_out(const QueryJob& job, const std::string& mark, const Rows& rows, const std::string& text,
             const std::string& markdown) {
  if (job.json != "-") fmt::print("{}", text);
  if (!job.json.empty()) {
    nlohmann::ordered_json json = nlohmann::ordered_json::array();
    for (const auto& row : rows) json.push_back(to_json(row));
    write_json(job.json, json);
  }
  if (!job.markdown.empty() && !bench::write_between_marks(job.markdown, mark, markdown))
    fail({"cannot write the file", "", "", job.markdown});
}

void run_pairs(const QueryJob& job) {
  const bench::PairsReport report = bench_pairs(job.options, report_progress);
  const std::string how = fmt::format("{}\nDistances proved by the referee: {} of {} poses.\n", report.how,
                                      report.proved, report.recorded);
  const bench::Table summary = against_peers(report.rows);
  put_out(job, "pairs", report.rows,
          fmt::format("{}\n* the fastest peer that answers every query, right to 1 um\n\n{}\n{}",
                      every_row(report.rows).text(), summary.text(), how),
          summary.markdown() + "\n" + how);
  if (!job.svg.empty() && !bench::write_text(job.svg, bench::pairs_plot(report.rows)))
    fail({"cannot write the file", "", "", job.svg});
}

void run_penetration(const QueryJob& job) {
  const bench::PairsReport report = bench_penetration(job.options, report_progress);
  const std::string how =
      fmt::format("{}\nDepths proved to be the smallest by the referee: {} of {} poses.\n", report.how,
                  report.proved, report.recorded);
  const bench::Table summary = depths_against_peers(report.rows);
  put_out(job, "penetration", report.rows,
          fmt::format("{}\n{}\n{}", depth_rows(report.rows).text(), summary.text(), how),
          summary.markdown() + "\n" + how);
}

void run_manifold(const QueryJob& job) {
  const bench::ManifoldReport report = bench_manifold(job.options, report_progress);
  const bench::Table table = table_of(report);
  put_out(job, "manifold", report.rows, table.text() + "\n" + report.how + "\n",
          table.markdown() + "\n" + report.how + "\n");
}

void run_impact(const QueryJob& job) {
  const bench::ImpactReport report = bench_impact(job.options, report_progress);
  const bench::Table table = table_of(report);
  put_out(job, "impact", report.rows, table.text() + "\n" + report.how + "\n",
          table.markdown() + "\n" + report.how + "\n");
}

/// A subcommand with the options that all four have.
CLI::App* add_command(CLI::App& parent, const std::string& name, const std::string& what,
                      std::span<const bench::Pair> pairs, const std::shared_ptr<QueryJob>& job,
                      void (*run)(const QueryJob&)) {
  CLI::App* command = parent.add_subcommand(name, what);
  command->add_option("--shapes", job->options.shapes, "pairs by name, with commas")
      ->delimiter(',')
      ->check(CLI::IsMember(bench::names_of(pairs)));
  command->add_option("--frames", job->options.frames, "poses of each recording")
      ->check(CLI::Range(100, 10000000))
      ->capture_default_str();
  command->add_option("--replays", job->options.replays, "each pose counts with its fastest replay")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_flag("--quick", job->options.quick, "few poses: does everything work?");
  command->add_option("--json", job->json,
                      "write a row a measurement to this file (- for standard output, alone)");
  command->add_option(
      "--markdown", job->markdown,
      "write the table to this file, between its marks when it has them (docs/benchmarks.md)");
  command->callback([job, run] { run(*job); });
  return command;
}

void add_peer_options(CLI::App& command, QueryJob& job) {
  command.add_option("--engines", job.options.engines, "with commas")
      ->delimiter(',')
      ->check(CLI::IsMember(bench::engine_names()));
  command
      .add_option("--peer-seconds", job.options.peer_budget_s,
                  "time for each peer on each recording; slow ones answer fewer poses of it")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command
      .add_option("--referee-seconds", job.options.referee_s,
                  "time for the search of all depths on each recording of overlapping pieces")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
}

void add_regimes(CLI::App& command, QueryJob& job, const std::vector<bench::Regime>& regimes) {
  std::vector<std::string> names;
  for (const bench::Regime& regime : regimes) names.push_back(regime.name);
  command.add_option("--regimes", job.options.regimes, "with commas")
      ->delimiter(',')
      ->check(CLI::IsMember(names));
}

}  // namespace

void add_bench_pairs(CLI::App& parent) {
  auto job = std::make_shared<QueryJob>();
  CLI::App* command =
      add_command(parent, "pairs", "Distances of convex pieces, beside FCL, libccd, Bullet and ODE",
                  bench::distance_pairs(), job, run_pairs);
  add_peer_options(*command, *job);
  add_regimes(*command, *job, bench::regimes());
  command->add_option("--svg", job->svg, "draw the cost against the number of vertices to this file");
}

void add_bench_penetration(CLI::App& parent) {
  auto job = std::make_shared<QueryJob>();
  CLI::App* command =
      add_command(parent, "penetration", "Depths of overlaps, and how often they are the smallest",
                  bench::depth_pairs(), job, run_penetration);
  add_peer_options(*command, *job);
  add_regimes(*command, *job, bench::depth_regimes());
}

void add_bench_manifold(CLI::App& parent) {
  add_command(parent, "manifold", "Contact patches, and how steady they are", bench::patch_pairs(),
              std::make_shared<QueryJob>(), run_manifold);
}

void add_bench_impact(CLI::App& parent) {
  add_command(parent, "impact", "Times of impact, and how tight they are", bench::impact_pairs(),
              std::make_shared<QueryJob>(), run_impact);
}

}  // namespace tactum
