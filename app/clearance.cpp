#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "bench/distance_peer.h"
#include "commands.h"
#include "tactum/devices/motion_file.h"
#include "tactum/mesh/mesh_import.h"
#include "tactum/mesh/part_file.h"
#include "tactum/surface/surface_distance.h"

/// `tactum clearance A B MOTION.csv`: exact distance of two surfaces for every row of a motion.

namespace tactum {
namespace {

struct Options {
  std::string mesh_a, mesh_b, motion;
  std::string csv, json;  ///< files to write; both empty: CSV on stdout
  double scale = 1.0;     ///< metres per unit of the files [m]
  bool beside_fcl = false;
};

struct Row {
  std::int64_t frame = 0;
  double time_s = 0.0;
  double distance_m = 0.0;
  int touching_pairs = 0;
  double took_ns = 0.0;      ///< the fastest of a few
  double fcl_m = 0.0;        ///< FCL's distance, when asked for [m]
  double fcl_took_ns = 0.0;  ///< ... and its time
};

TriangleMesh read_surface(const std::string& path, double scale) {
  if (is_part_file(path)) {
    const Result<PartFile> part = load_part(path);
    if (!part) fail(part.error());
    return surface_in_mesh_frame(*part);  // in metres, as prepared
  }
  const Result<ImportedMesh> mesh = import_mesh(path, {.scale = scale});
  if (!mesh) fail(mesh.error());
  for (const std::string& remark : mesh->report.remarks) fmt::print(stderr, "{}: {}\n", path, remark);
  return mesh->mesh;
}

using Clock = std::chrono::steady_clock;

double ns_since(Clock::time_point start) {
  return std::chrono::duration<double, std::nano>(Clock::now() - start).count();
}

std::vector<Pose> relative_poses(const TwoBodyMotion& motion, double scale) {
  std::vector<Pose> poses;
  poses.reserve(motion.frame.size());
  for (std::size_t i = 0; i < motion.frame.size(); ++i) {
    poses.push_back(relative_pose(motion.X_WA[i], motion.X_WB[i]));
    poses.back().p *= scale;
  }
  return poses;
}

std::vector<Row> distances(const TriangleMesh& mesh_a, const TriangleMesh& mesh_b,
                           const TwoBodyMotion& motion, const std::vector<Pose>& poses) {
  const Surface a(mesh_a), b(mesh_b);
  std::vector<Row> rows;
  rows.reserve(poses.size());
  SurfacePairCache cache;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Clock::time_point start = Clock::now();
    const SurfaceDistance answer = surface_distance(a, b, poses[i], cache);
    rows.push_back(
        {motion.frame[i], motion.time_s[i], answer.distance, answer.touching_pairs, ns_since(start)});
  }
  return rows;
}

/// Times ours and FCL, row after row in turn, so that what else the machine does strikes both; as FCL does,
/// ours ends at the first touching pair. Each row counts with its fastest of three.
void measure_beside_fcl(const TriangleMesh& mesh_a, const TriangleMesh& mesh_b,
                        const std::vector<Pose>& poses, std::vector<Row>& rows) {
  const std::unique_ptr<bench::DistancePeer> fcl = bench::distance_peer(mesh_a, mesh_b);
  if (!fcl) fail(Error{"this build cannot stand beside FCL", "", "libfcl-dev when it was configured", ""});
  const Surface a(mesh_a), b(mesh_b);
  for (int replay = 0; replay < 3; ++replay) {
    SurfacePairCache cache;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      Clock::time_point start = Clock::now();
      surface_distance(a, b, poses[i], cache, TouchingPairs::kFirst);
      const double own = ns_since(start);
      rows[i].took_ns = replay == 0 ? own : std::min(rows[i].took_ns, own);
      start = Clock::now();
      rows[i].fcl_m = fcl->distance(poses[i]);
      const double took = ns_since(start);
      rows[i].fcl_took_ns = replay == 0 ? took : std::min(rows[i].fcl_took_ns, took);
    }
  }
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
  if (options.beside_fcl) {
    out["mean_us"] = mean_us(rows, &Row::took_ns);
    out["fcl_mean_us"] = mean_us(rows, &Row::fcl_took_ns);
    out["rows_slower_than_fcl"] = slower_than_fcl(rows);
  }
  for (const Row& row : rows) {
    nlohmann::json one = {{"frame", row.frame},
                          {"time_s", row.time_s},
                          {"distance_m", row.distance_m},
                          {"touching_pairs", row.touching_pairs}};
    if (options.beside_fcl) {
      one["us"] = row.took_ns * 1e-3;
      one["fcl_us"] = row.fcl_took_ns * 1e-3;
      one["fcl_distance_m"] = row.fcl_m;
    }
    out["rows"].push_back(std::move(one));
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
  const TriangleMesh a = read_surface(options.mesh_a, options.scale);
  const TriangleMesh b = read_surface(options.mesh_b, options.scale);
  const Result<TwoBodyMotion> motion = read_two_body_motion(options.motion);
  if (!motion) fail(motion.error());
  if (motion->frame.empty())
    fail(Error{"the motion is empty", "no rows", "at least one row", options.motion});
  const std::string repairs = motion->repairs.sentence(motion->frame.size());
  if (!repairs.empty()) fmt::print(stderr, "{}: {}\n", options.motion, repairs);

  const std::vector<Pose> poses = relative_poses(*motion, options.scale);
  std::vector<Row> rows = distances(a, b, *motion, poses);
  if (options.beside_fcl) measure_beside_fcl(a, b, poses, rows);

  if (!options.csv.empty()) write_file(options.csv, as_csv(rows));
  if (!options.json.empty()) write_file(options.json, as_json(options, *motion, rows));
  if (options.csv.empty() && options.json.empty()) fmt::print("{}", as_csv(rows));
  fmt::print(stderr, "{} rows, {} touching; least distance {:.9g} m in frame {}; {:.3g} us a row\n",
             rows.size(), touching(rows), nearest(rows).distance_m, nearest(rows).frame,
             mean_us(rows, &Row::took_ns));
  if (options.beside_fcl)
    fmt::print(stderr, "FCL {:.3g} us a row; in {} rows it is the faster one\n",
               mean_us(rows, &Row::fcl_took_ns), slower_than_fcl(rows));
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
  command->add_flag("--beside-fcl", options->beside_fcl,
                    "time FCL's distance on the same poses, in a build that has it");
  command->callback([options] { run(*options); });
}

}  // namespace tactum
