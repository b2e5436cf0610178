#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "clearance_job.h"
#include "commands.h"
#include "tactum/devices/motion_file.h"
#include "tactum/mesh/mesh_import.h"
#include "tactum/mesh/part_file.h"
#include "tactum/repair/mesh_interior.h"
#include "tactum/surface/surface_distance.h"

/// `tactum clearance A B MOTION.csv`: exact distance of two meshes for every row of a motion; zero where one
/// lies inside a solid of the other.

namespace tactum {
namespace {

struct ClearanceOptions {
  ClearanceFiles files;
  std::string csv, json;  ///< files to write; both empty: CSV on stdout
};

struct Row {
  std::int64_t frame = 0;
  double time_s = 0.0;
  double distance_m = 0.0;
  int touching_pairs = 0;
  bool inside = false;  ///< no triangles touch, but one mesh lies in a solid of the other
  double took_ns = 0.0;
};

using Clock = std::chrono::steady_clock;

double ns_since(Clock::time_point start) {
  return std::chrono::duration<double, std::nano>(Clock::now() - start).count();
}

std::vector<Row> distances(const ClearanceJob& job) {
  const Surface a(job.a), b(job.b);
  const MeshInterior inside_a(job.a), inside_b(job.b);
  std::vector<Row> rows;
  rows.reserve(job.X_AB.size());
  SurfacePairCache cache;
  for (std::size_t i = 0; i < job.X_AB.size(); ++i) {
    const Clock::time_point start = Clock::now();
    const SurfaceDistance answer = surface_distance(a, b, job.X_AB[i], cache);
    const bool inside = answer.touching_pairs == 0 && one_inside_other(inside_a, inside_b, job.X_AB[i]);
    rows.push_back({job.motion.frame[i], job.motion.time_s[i], inside ? 0.0 : answer.distance,
                    answer.touching_pairs, inside, ns_since(start)});
  }
  return rows;
}

double mean_us(const std::vector<Row>& rows) {
  double sum = 0.0;
  for (const Row& row : rows) sum += row.took_ns;
  return sum * 1e-3 / static_cast<double>(rows.size());
}

std::string as_csv(const std::vector<Row>& rows) {
  std::string text = "frame,time_s,distance_m,touching_pairs\n";
  for (const Row& row : rows) {
    text += fmt::format("{},{},{},{}\n", row.frame, row.time_s, row.distance_m, row.touching_pairs);
  }
  return text;
}

const Row& nearest(const std::vector<Row>& rows) {
  return *std::min_element(rows.begin(), rows.end(),
                           [](const Row& x, const Row& y) { return x.distance_m < y.distance_m; });
}

std::ptrdiff_t touching(const std::vector<Row>& rows) {
  return std::count_if(rows.begin(), rows.end(),
                       [](const Row& row) { return row.touching_pairs > 0 || row.inside; });
}

std::string as_json(const ClearanceOptions& options, const ClearanceJob& job, const std::vector<Row>& rows) {
  nlohmann::json out = {{"a", options.files.mesh_a},
                        {"b", options.files.mesh_b},
                        {"motion", options.files.motion},
                        {"min_distance_m", nearest(rows).distance_m},
                        {"min_distance_frame", nearest(rows).frame},
                        {"touching_rows", touching(rows)},
                        {"orthonormalized_rows", job.motion.repairs.orthonormalized_rows},
                        {"rows", nlohmann::json::array()}};
  for (const Row& row : rows) {
    out["rows"].push_back({{"frame", row.frame},
                           {"time_s", row.time_s},
                           {"distance_m", row.distance_m},
                           {"inside", row.inside},
                           {"touching_pairs", row.touching_pairs}});
  }
  return out.dump(1) + "\n";
}

void write_file(const std::string& path, const std::string& text) {
  if (path == "-") {
    fmt::print("{}", text);
    return;
  }
  std::ofstream file(path, std::ios::binary);
  if (!(file << text) || !file.flush())
    fail(Error{"the file cannot be written", "", "a writable place", path});
}

void run(const ClearanceOptions& options) {
  const ClearanceJob job = read_clearance_job(options.files);
  const std::vector<Row> rows = distances(job);
  if (!options.csv.empty()) write_file(options.csv, as_csv(rows));
  if (!options.json.empty()) write_file(options.json, as_json(options, job, rows));
  if (options.csv.empty() && options.json.empty()) fmt::print("{}", as_csv(rows));
  const auto inside = std::count_if(rows.begin(), rows.end(), [](const Row& row) { return row.inside; });
  if (inside > 0)
    fmt::print(stderr, "In {} row{} one mesh lies inside a solid of the other, which counts as touching.\n",
               inside, inside == 1 ? "" : "s");
  fmt::print(stderr, "{} row{}, {} touching; least distance {:.9g} m in frame {}; {:.3g} us a row\n",
             rows.size(), rows.size() == 1 ? "" : "s", touching(rows), nearest(rows).distance_m,
             nearest(rows).frame, mean_us(rows));
}

}  // namespace

void add_clearance(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("clearance", "Compute the exact distance of two meshes along a motion of both");
  auto options = std::make_shared<ClearanceOptions>();
  add_clearance_files(*command, options->files);
  command->add_option("--csv", options->csv, "Write frame,time_s,distance_m,touching_pairs to this file");
  command->add_option("--json", options->json, "Write rows and summary to this file");
  command->callback([options] { run(*options); });
}

}  // namespace tactum
