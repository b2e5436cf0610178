#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "tactum/collision/surface_distance.h"
#include "tactum/devices/motion_file.h"
#include "tactum/geometry/mesh_import.h"
#include "tactum/geometry/part_file.h"

/// `tactum clearance A B MOTION.csv`: exact distance of two surfaces for every row of a motion.

namespace tactum {
namespace {

struct Options {
  std::string mesh_a, mesh_b, motion;
  std::string csv, json;  ///< files to write; both empty: CSV on stdout
  double scale = 1.0;     ///< metres per unit of the files [m]
};

struct Row {
  std::int64_t frame = 0;
  double time_s = 0.0;
  double distance_m = 0.0;
  int touching_pairs = 0;
};

Surface read_surface(const std::string& path, double scale) {
  if (is_part_file(path)) {
    const Result<PartFile> part = load_part(path);
    if (!part) fail(part.error());
    return Surface(surface_in_mesh_frame(*part));  // in metres, as prepared
  }
  const Result<ImportedMesh> mesh = import_mesh(path, {.scale = scale});
  if (!mesh) fail(mesh.error());
  for (const std::string& remark : mesh->report.remarks) fmt::print(stderr, "{}: {}\n", path, remark);
  return Surface(mesh->mesh);
}

std::vector<Row> distances(const Surface& a, const Surface& b, const TwoBodyMotion& motion, double scale) {
  std::vector<Row> rows;
  rows.reserve(motion.frame.size());
  SurfacePairCache cache;
  for (std::size_t i = 0; i < motion.frame.size(); ++i) {
    Pose X_AB = relative_pose(motion.X_WA[i], motion.X_WB[i]);
    X_AB.p *= scale;
    const SurfaceDistance answer = surface_distance(a, b, X_AB, cache);
    rows.push_back({motion.frame[i], motion.time_s[i], answer.distance, answer.touching_pairs});
  }
  return rows;
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
  return std::count_if(rows.begin(), rows.end(), [](const Row& row) { return row.touching_pairs > 0; });
}

std::string as_json(const Options& options, const TwoBodyMotion& motion, const std::vector<Row>& rows) {
  nlohmann::json out = {{"a", options.mesh_a},
                        {"b", options.mesh_b},
                        {"motion", options.motion},
                        {"min_distance_m", nearest(rows).distance_m},
                        {"min_distance_frame", nearest(rows).frame},
                        {"touching_rows", touching(rows)},
                        {"orthonormalized_rows", motion.repairs.orthonormalized_rows},
                        {"rows", nlohmann::json::array()}};
  for (const Row& row : rows) {
    out["rows"].push_back({{"frame", row.frame},
                           {"time_s", row.time_s},
                           {"distance_m", row.distance_m},
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

void run(const Options& options) {
  const Surface a = read_surface(options.mesh_a, options.scale);
  const Surface b = read_surface(options.mesh_b, options.scale);
  const Result<TwoBodyMotion> motion = read_two_body_motion(options.motion);
  if (!motion) fail(motion.error());
  if (motion->frame.empty())
    fail(Error{"the motion is empty", "no rows", "at least one row", options.motion});
  const std::string repairs = motion->repairs.sentence(motion->frame.size());
  if (!repairs.empty()) fmt::print(stderr, "{}: {}\n", options.motion, repairs);

  const auto start = std::chrono::steady_clock::now();
  const std::vector<Row> rows = distances(a, b, *motion, options.scale);
  const std::chrono::duration<double, std::milli> taken = std::chrono::steady_clock::now() - start;

  if (!options.csv.empty()) write_file(options.csv, as_csv(rows));
  if (!options.json.empty()) write_file(options.json, as_json(options, *motion, rows));
  if (options.csv.empty() && options.json.empty()) fmt::print("{}", as_csv(rows));
  fmt::print(stderr, "{} rows, {} touching; least distance {:.9g} m in frame {}; {:.3g} ms a row\n",
             rows.size(), touching(rows), nearest(rows).distance_m, nearest(rows).frame,
             taken.count() / static_cast<double>(rows.size()));
}

}  // namespace

void add_clearance(CLI::App& app) {
  CLI::App* command = app.add_subcommand("clearance", "Exact distance of two meshes along a motion of both.");
  auto options = std::make_shared<Options>();
  command->add_option("A", options->mesh_a, "Mesh of the first body")->required();
  command->add_option("B", options->mesh_b, "Mesh of the second body")->required();
  command->add_option("MOTION", options->motion, "CSV with a pose of A and of B in every row")->required();
  command->add_option("--csv", options->csv, "Write frame,time_s,distance_m,touching_pairs to this file");
  command->add_option("--json", options->json, "Write rows and summary to this file");
  command->add_option("--scale", options->scale, "Metres per unit of the meshes and of the motion")
      ->check(CLI::PositiveNumber);
  command->callback([options] { run(*options); });
}

}  // namespace tactum
