/// tactum-bench feel: what is felt against analytic truth, beside rigid-body engines (bench/feel.h); with
/// --scenes what reaches the hand in the shipped scenes, on every device (bench/scene_feel.h).

#include <fmt/format.h>

#include "bench/feel.h"
#include "bench/main/commands.h"
#include "bench/pairs_plot.h"
#include "bench/scene_feel.h"

namespace tactum {
namespace {

struct FeelJob {
  bench::FeelOptions options;
  bench::SceneFeelOptions scenes;
  bool of_scenes = false;
  bool alone = false;
  std::string json, markdown, svg;
};

void put(const std::string& path, const std::string& name, const bench::Table& table) {
  if (!bench::write_between_marks(path, name, table.markdown()))
    fail({"cannot write the file", "", "", path});
}

void run_scenes(const FeelJob& job) {
  const Result<std::vector<bench::SceneFeelRow>> rows =
      bench_scene_feel(job.scenes, [](const std::string& scene) { fmt::print(stderr, "{}\n", scene); });
  if (!rows) fail(rows.error());
  const bench::Table table = table_of(*rows);
  if (job.json != "-") fmt::print("{}", table.text());
  if (!job.json.empty()) {
    nlohmann::ordered_json json = nlohmann::ordered_json::array();
    for (const bench::SceneFeelRow& row : *rows) json.push_back(to_json(row));
    write_json(job.json, json);
  }
  if (!job.markdown.empty()) put(job.markdown, "feel scenes", table);
}

void run_feel(FeelJob& job) {
  if (job.of_scenes) return run_scenes(job);
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
  command->add_option("--truths", job->options.scenes, "those of analytic truth, by name, with commas")
      ->delimiter(',')
      ->check(CLI::IsMember(names));
  CLI::Option* scenes =
      command
          ->add_option(
              "--scenes", job->scenes.scenes,
              "instead, what reaches the hand in these scenes, with commas; alone: in every shipped one")
          ->delimiter(',')
          ->expected(0, -1);
  command->add_option("--devices", job->scenes.devices, "presets for --scenes, with commas; by default all")
      ->delimiter(',')
      ->needs(scenes);
  command->add_option("--grips", job->scenes.hands, "loose, medium, firm, for --scenes; by default all")
      ->delimiter(',')
      ->needs(scenes);
  command
      ->add_option("--responses", job->scenes.responses, "constraint, penalty, for --scenes; by default both")
      ->delimiter(',')
      ->check(CLI::IsMember({"constraint", "penalty"}))
      ->needs(scenes);
  command->add_option("--seconds", job->scenes.most_s, "at most so much of each scene's motion [s]")
      ->needs(scenes);
  command->add_option("--hands", job->options.hands, "that lead each peg; 0: no pegs")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
  command->add_flag("--alone", job->alone, "without the other engines");
  command->add_option("--json", job->json, "write the rows to this file (- for standard output, alone)");
  command->add_option("--markdown", job->markdown,
                      "write the tables to this file, between its marks (docs/benchmarks.md)");
  command->add_option("--svg", job->svg, "draw the pegs into this file");
  command->callback([job, scenes] {
    job->of_scenes = scenes->count() > 0;
    std::erase(job->scenes.scenes, "");  // of --scenes alone
    run_feel(*job);
  });
}

}  // namespace tactum
