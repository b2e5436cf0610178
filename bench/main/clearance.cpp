/// tactum-bench clearance: the exact distance of two meshes along a motion, beside FCL's on the same poses.

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>

#include "app/clearance_job.h"
#include "bench/distance_peer.h"
#include "bench/main/commands.h"
#include "tactum/surface/surface_distance.h"

namespace tactum {
namespace {

struct Options {
  ClearanceFiles files;
  std::string json;
};

struct Row {
  double distance_m = 0.0;
  double took_ns = 0.0;      ///< the fastest of three
  double fcl_m = 0.0;        ///< FCL's distance [m]
  double fcl_took_ns = 0.0;  ///< ... and its time
};

using Clock = std::chrono::steady_clock;

double ns_since(Clock::time_point start) {
  return std::chrono::duration<double, std::nano>(Clock::now() - start).count();
}

/// Row after row in turn, so that what else the machine does strikes both; as FCL does, ours ends at the
/// first touching pair.
std::vector<Row> measure(const ClearanceJob& job) {
  const std::unique_ptr<bench::DistancePeer> fcl = bench::distance_peer(job.a, job.b);
  if (!fcl) fail(Error{"this build cannot stand beside FCL", "", "libfcl-dev when it was configured", ""});
  const Surface a(job.a), b(job.b);
  std::vector<Row> rows(job.X_AB.size());
  for (int replay = 0; replay < 3; ++replay) {
    SurfacePairCache cache;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      Clock::time_point start = Clock::now();
      rows[i].distance_m = surface_distance(a, b, job.X_AB[i], cache, TouchingPairs::kFirst).distance;
      const double own = ns_since(start);
      rows[i].took_ns = replay == 0 ? own : std::min(rows[i].took_ns, own);
      start = Clock::now();
      rows[i].fcl_m = fcl->distance(job.X_AB[i]);
      const double took = ns_since(start);
      rows[i].fcl_took_ns = replay == 0 ? took : std::min(rows[i].fcl_took_ns, took);
    }
  }
  return rows;
}

double mean_us(const std::vector<Row>& rows, double Row::*took) {
  double sum = 0.0;
  for (const Row& row : rows) sum += row.*took;
  return sum * 1e-3 / static_cast<double>(rows.size());
}

std::ptrdiff_t slower_than_fcl(const std::vector<Row>& rows) {
  return std::count_if(rows.begin(), rows.end(),
                       [](const Row& row) { return row.took_ns > row.fcl_took_ns; });
}

nlohmann::ordered_json to_json(const ClearanceJob& job, const std::vector<Row>& rows) {
  nlohmann::ordered_json out = {{"mean_us", mean_us(rows, &Row::took_ns)},
                                {"fcl_mean_us", mean_us(rows, &Row::fcl_took_ns)},
                                {"rows_slower_than_fcl", slower_than_fcl(rows)},
                                {"rows", nlohmann::ordered_json::array()}};
  for (std::size_t i = 0; i < rows.size(); ++i)
    out["rows"].push_back({{"frame", job.motion.frame[i]},
                           {"time_s", job.motion.time_s[i]},
                           {"distance_m", rows[i].distance_m},
                           {"us", rows[i].took_ns * 1e-3},
                           {"fcl_us", rows[i].fcl_took_ns * 1e-3},
                           {"fcl_distance_m", rows[i].fcl_m}});
  return out;
}

void run(const Options& options) {
  const ClearanceJob job = read_clearance_job(options.files);
  const std::vector<Row> rows = measure(job);
  if (options.json != "-")
    fmt::print("{} rows; {:.3g} us a row, FCL {:.3g} us; in {} rows it is the faster one\n", rows.size(),
               mean_us(rows, &Row::took_ns), mean_us(rows, &Row::fcl_took_ns), slower_than_fcl(rows));
  if (!options.json.empty()) write_json(options.json, to_json(job, rows));
}

}  // namespace

void add_bench_clearance(CLI::App& parent) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      parent.add_subcommand("clearance", "The distance of two meshes along a motion, beside FCL's");
  add_clearance_files(*command, options->files);
  command->add_option("--json", options->json, "write the rows to this file (- for standard output, alone)");
  command->callback([options] { run(*options); });
}

}  // namespace tactum
