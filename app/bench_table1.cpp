/// tactum bench table1: the paper's Table 1, measured on the same job: 12 499 updates of the gears.

#include <fmt/format.h>

#include <array>

#include "commands.h"
#include "output.h"
#include "tactum/scene/builtin_scenes.h"
#include "tactum/session/session.h"

namespace tactum {
namespace {

struct Table1Options {
  std::string scene = "gears";
  std::uint64_t updates = 12499;
  int replays = 5;
  std::string json;
};

/// The paper's figures, in its units of milliseconds [Gregory 2000, Table 1].
struct Published {
  static constexpr double kWorst_ms = 0.34300, kAverage_ms = 0.178922, kCollision_ms = 0.071615;
  static constexpr double kNbody_ms = 0.040022, kExact_ms = 0.001291, kResponse_ms = 0.092331;
  static constexpr int kUpdates = 12499, kCollisionTests = 12499, kNbodyTests = 7285, kExactTests = 38989,
                       kCollisions = 10870;
};

struct Table1 {
  RunRecord record;
  double average_us = 0.0, worst_us = 0.0, worst_us_min_of_replays = 0.0;
  double collision_average_us = 0.0, nbody_average_us = 0.0, exact_average_us = 0.0,
         response_average_us = 0.0;
  std::uint64_t missed_deadlines = 0;
  std::uint64_t collision_tests = 0;
  Summary least;  // per-frame minimum over the replays
};

std::unique_ptr<Session> open_gears(const Table1Options& options) {
  Result<Scene> scene = open_scene(options.scene);
  if (!scene) fail(scene.error());
  scene->settings.response = ResponseModel::kPenalty;  // the published one
  Result<std::unique_ptr<Session>> session = Session::open(std::move(*scene), {});
  if (!session) fail(session.error());
  return std::move(*session);
}

/// The frames' own times: no observer between the stages.
class WholeFrames final : public LoopObserver {
 public:
  WholeFrames(MinimumOfReplays& least, double period_s) : least_(least), period_s_(period_s) {}
  bool after_frame(const FrameRecord& record) noexcept override {
    least_.add(record.tick.index, static_cast<std::int64_t>(record.frame_time_s * 1e9));
    sum_s += record.frame_time_s;
    worst_s = std::max(worst_s, record.frame_time_s);
    if (record.frame_time_s > period_s_) ++missed;
    return true;
  }
  double sum_s = 0.0, worst_s = 0.0;
  std::uint64_t missed = 0;

 private:
  MinimumOfReplays& least_;
  double period_s_;
};

/// The stages' times, in a replay of their own because measuring costs time.
class Stages final : public LoopObserver {
 public:
  explicit Stages(Session& session) : session_(session) { session.time_stages(&clock_); }
  bool after_frame(const FrameRecord&) noexcept override {
    const FrameReport& report = session_.last_report();
    const double near_ns = static_cast<double>(clock_.stage_ns(Stage::kNearPairs));
    const double exact_ns = static_cast<double>(clock_.stage_ns(Stage::kExactTests));
    if (!(report.flags & frame_flag::kNoHand)) {
      ++detections;
      detection_ns += near_ns + exact_ns;
      tests_ns += exact_ns;
    }
    if (report.work.broad_phase_runs > 0) broad_ns += near_ns;
    if (report.in_contact()) response_ns += static_cast<double>(clock_.stage_ns(Stage::kResponse));
    return true;
  }
  std::uint64_t detections = 0;
  double detection_ns = 0.0, broad_ns = 0.0, tests_ns = 0.0, response_ns = 0.0;

 private:
  Session& session_;
  StageClock clock_;
};

double average_us(double sum_ns, std::uint64_t count) {
  return count == 0 ? 0.0 : sum_ns / static_cast<double>(count) * 1e-3;
}

Table1 measure(const Table1Options& options) {
  Table1 table;
  MinimumOfReplays least(options.updates);
  std::uint64_t hash = 0;
  double sum_s = 0.0;
  for (int replay = 0; replay < options.replays; ++replay) {
    const std::unique_ptr<Session> session = open_gears(options);
    WholeFrames watch(least, session->scene().settings.dt_s);
    if (const auto run = session->run_virtual(options.updates, &watch); !run) fail(run.error());
    if (replay > 0 && session->record().hash() != hash)
      fail({fmt::format("replay {} computed other frames than the first", replay),
            "hash " + hash_text(session->record().hash()), hash_text(hash), options.scene});
    hash = session->record().hash();
    sum_s += watch.sum_s;
    table.missed_deadlines += watch.missed;
    table.worst_us = std::max(table.worst_us, watch.worst_s * 1e6);
  }
  table.average_us =
      sum_s * 1e6 / static_cast<double>(options.replays) / static_cast<double>(options.updates);
  table.least = least.summary();
  table.worst_us_min_of_replays = table.least.max_ns * 1e-3;

  const std::unique_ptr<Session> session = open_gears(options);
  Stages stages(*session);
  if (const auto run = session->run_virtual(options.updates, &stages); !run) fail(run.error());
  table.record = session->record();
  table.collision_tests = stages.detections;
  table.collision_average_us = average_us(stages.detection_ns, stages.detections);
  table.nbody_average_us = average_us(stages.broad_ns, table.record.sum("work.broad_phase_runs"));
  table.exact_average_us = average_us(stages.tests_ns, table.record.sum("work.exact_tests"));
  table.response_average_us = average_us(stages.response_ns, table.record.colliding_frames);
  return table;
}

void print(const Table1& table, const Table1Options& options) {
  const auto row = [](const char* what, const std::string& here, const std::string& published) {
    fmt::print("{:<38}{:>14}{:>14}\n", what, here, published);
  };
  const auto ms = [](double us) { return fmt::format("{:.6f}", us * 1e-3); };
  const auto published_ms = [](double value) { return fmt::format("{:.6f}", value); };
  row("System component (times in ms)", "here", "published");
  row("Number of updates", fmt::to_string(table.record.frames), fmt::to_string(Published::kUpdates));
  row("Worst time", ms(table.worst_us), published_ms(Published::kWorst_ms));
  row(fmt::format("Worst time, least of {} replays", options.replays).c_str(),
      ms(table.worst_us_min_of_replays), "");
  row("Average time", ms(table.average_us), published_ms(Published::kAverage_ms));
  row(fmt::format("Average, frames' least of {} replays", options.replays).c_str(),
      ms(table.least.mean_ns * 1e-3), "");
  row("Total collision detection tests", fmt::to_string(table.collision_tests),
      fmt::to_string(Published::kCollisionTests));
  row("Average collision detection time", ms(table.collision_average_us),
      published_ms(Published::kCollision_ms));
  row("Total N-body tests", fmt::to_string(table.record.sum("work.broad_phase_runs")),
      fmt::to_string(Published::kNbodyTests));
  row("Average N-body time", ms(table.nbody_average_us), published_ms(Published::kNbody_ms));
  row("Total exact CD tests", fmt::to_string(table.record.sum("work.exact_tests")),
      fmt::to_string(Published::kExactTests));
  row("Average exact CD time", ms(table.exact_average_us), published_ms(Published::kExact_ms));
  row("Total number of collisions", fmt::to_string(table.record.colliding_frames),
      fmt::to_string(Published::kCollisions));
  row("Average response time", ms(table.response_average_us), published_ms(Published::kResponse_ms));
  row("Missed deadlines", fmt::to_string(table.missed_deadlines), "");
  fmt::print("frames' hash {}\n", hash_text(table.record.hash()));
}

nlohmann::ordered_json to_json(const Table1& table) {
  return {{"updates", table.record.frames},
          {"average_us", table.average_us},
          {"worst_us", table.worst_us},
          {"worst_us_min_of_replays", table.worst_us_min_of_replays},
          {"collision_tests", table.collision_tests},
          {"collision_average_us", table.collision_average_us},
          {"nbody_tests", table.record.sum("work.broad_phase_runs")},
          {"nbody_average_us", table.nbody_average_us},
          {"exact_tests", table.record.sum("work.exact_tests")},
          {"exact_average_us", table.exact_average_us},
          {"collisions", table.record.colliding_frames},
          {"response_average_us", table.response_average_us},
          {"missed_deadlines", table.missed_deadlines},
          {"frame_us_min_of_replays", summary_us(table.least)},
          {"frame_hash", hash_text(table.record.hash())}};
}

void bench_table1(const Table1Options& options) {
  const Table1 table = measure(options);
  if (options.json != "-") print(table, options);
  if (!options.json.empty()) write_json(options.json, to_json(table));
}

}  // namespace

void add_bench(CLI::App& app) {
  CLI::App* bench = app.add_subcommand("bench", "Measure the frame; tactum-bench measures the rest");
  bench->require_subcommand(1);
  auto options = std::make_shared<Table1Options>();
  CLI::App* table1 =
      bench->add_subcommand("table1", "Print the timing table of the paper, beside the published values");
  table1->add_option("--scene", options->scene, "Measure another scene than the gears")
      ->capture_default_str();
  table1->add_option("--updates", options->updates, "Run so many frames")
      ->check(CLI::Range(1, 100000000))
      ->capture_default_str();
  table1
      ->add_option("--replays", options->replays,
                   "Repeat the run so many times, identically; the second worst and average time are those "
                   "of the fastest "
                   "run of each frame")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  table1->add_option("--json", options->json,
                     "Write the figures to this file (- for standard output, alone)");
  table1->callback([options] { bench_table1(*options); });
}

}  // namespace tactum
