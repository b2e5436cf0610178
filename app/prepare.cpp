#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "commands.h"
#include "output.h"
#include "part_cache.h"
#include "part_text.h"
#include "step_meshes.h"
#include "tactum/base/parallel.h"
#include "tactum/mesh/mapped_file.h"
#include "tactum/mesh/prepare_part.h"

/// `tactum prepare MESH... -o PART`: meshes read, repaired, cut into pieces, verified and written as a part.

namespace tactum {
namespace {

struct PrepareCommand {
  std::vector<std::string> meshes;
  std::string part;
  std::string json;   ///< file to write, "-" for stdout
  std::string cache;  ///< folder; empty: the user's
  bool no_cache = false;
  std::string fit;  ///< of STEP files
  PrepareOptions prepare;
};

/// A bar on stderr, when that is a terminal.
class Bar {
 public:
  void show(const char* stage, double share) const {
    constexpr int kWidth = 30;
    if (!on_) return;
    const int full = static_cast<int>(share * kWidth);
    fmt::print(stderr, "\r[{:=<{}}{: <{}}] {: <24}", "", full, "", kWidth - full, stage);
    std::fflush(stderr);
  }
  void clear() const {
    if (on_) fmt::print(stderr, "\r{: <60}\r", "");
  }

 private:
  bool on_ = ::isatty(STDERR_FILENO) == 1;
};

/// The meshes as one; when there are several, each is a group.
Result<ImportedMesh> import_all(const std::vector<std::string>& paths, const PrepareOptions& options) {
  const bool finds_unit = options.unit == "auto" && options.scale == 0.0;
  ImportedMesh all;
  for (const std::string& path : paths) {
    Result<ImportedMesh> one = import_mesh(path);
    if (!one) return one.error();
    if (paths.size() == 1) return one;
    const bool differs = !all.groups.empty() && all.report.in_metres != one->report.in_metres;
    if (differs && finds_unit) {
      return Error{"the meshes may be in different units", "glTF, which is in metres, beside another format",
                   "--units, or --scale, of all", path};
    }
    const int vertices = static_cast<int>(all.mesh.vertices.size());
    const int triangles = static_cast<int>(all.mesh.triangles.size());
    for (Triangle t : one->mesh.triangles) {
      for (int& corner : t) corner += vertices;
      all.mesh.triangles.push_back(t);
    }
    all.mesh.vertices.insert(all.mesh.vertices.end(), one->mesh.vertices.begin(), one->mesh.vertices.end());
    all.groups.push_back({path, triangles, static_cast<int>(one->mesh.triangles.size())});
    all.report.format = one->report.format;
    all.report.in_metres = one->report.in_metres;
    for (const std::string& remark : one->report.remarks) all.report.remarks.push_back(path + ": " + remark);
  }
  return all;
}

Result<PartFile> prepared(const PrepareCommand& options, const Bar& bar) {
  bar.show("reading", 0.0);
  Result<ImportedMesh> mesh = import_all(options.meshes, options.prepare);
  if (!mesh) return mesh.error();
  const std::vector<std::string> remarks = mesh->report.remarks;
  Result<PartFile> part = prepare_part(std::move(*mesh), options.prepare,
                                       [&](const char* stage, double share) { bar.show(stage, share); });
  if (part) part->part.notes.remarks.insert(part->part.notes.remarks.begin(), remarks.begin(), remarks.end());
  return part;
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double peak_memory_MB() {
  struct rusage usage {};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

/// Replaces STEP files by their meshes, in metres.
void triangulate(PrepareCommand& options, StepMeshes& meshes) {
  const auto steps = std::count_if(options.meshes.begin(), options.meshes.end(), is_step_name);
  if (steps == 0) {
    if (!options.fit.empty())
      fail({"--fit is for STEP files", options.meshes.front(), "a .step or .stp file", ""});
    return;
  }
  if (steps < std::ssize(options.meshes))
    fail({"STEP files beside meshes", options.meshes.front(), "files of one kind", ""});
  if (options.prepare.unit != "auto" || options.prepare.scale != 0.0)
    fail({"a STEP file states its unit", "--units or --scale", "neither", options.meshes.front()});
  std::optional<double> fit_m;
  if (!options.fit.empty()) {
    const Result<double> length = length_with_unit(options.fit);
    if (!length) fail(length.error());
    fit_m = *length;
  }
  const Result<std::vector<std::string>> made = meshes.make(options.meshes, fit_m);
  if (!made) fail(made.error());
  options.meshes = *made;
  options.prepare.unit = "m";
  fmt::print(options.json == "-" ? stderr : stdout, "{}", meshes.report());
}

void run(PrepareCommand options) {
  const auto start = std::chrono::steady_clock::now();
  StepMeshes step_meshes;
  triangulate(options, step_meshes);
  const Bar bar;
  const PartCache cache = options.no_cache ? PartCache() : PartCache(options.cache);
  const std::string key = cache.key_of(options.meshes, options.prepare);
  Result<PartFile> part = cache.find(key);
  const bool known = static_cast<bool>(part);
  if (!known) part = prepared(options, bar);
  bar.clear();
  if (!part) fail(part.error());
  if (Result<void> saved = save_part(options.part, *part); !saved) fail(saved.error());
  if (!known) cache.keep(key, *part);

  std::string command = "tactum prepare";
  for (const std::string& mesh : options.meshes) command += " " + mesh;
  const std::string warning = unit_warning(command + " -o " + options.part, *part);
  fmt::print(options.json == "-" ? stderr : stdout, "{}", warning);

  const double bytes = static_cast<double>(std::filesystem::file_size(options.part));
  const double seconds = seconds_since(start);
  if (options.json != "-") {
    fmt::print("{}", describe_part(options.part, *part));
    fmt::print("written     {:.3g} MB in {:.2f} s, {:.0f} MB of memory at most\n", bytes / 1e6, seconds,
               peak_memory_MB());
    if (known) fmt::print("prepared before: taken from {}\n", cache.folder());
  }
  if (options.json.empty()) return;
  nlohmann::ordered_json json = part_json(options.part, *part);
  json["bytes"] = bytes;
  json["seconds"] = seconds;
  json["peak_memory_MB"] = peak_memory_MB();
  json["from_cache"] = known;
  write_json(options.json, json);
}

}  // namespace

void add_prepare(CLI::App& app) {
  CLI::App* command = app.add_subcommand("prepare", "Make a verified part of meshes, ready to be felt");
  auto options = std::make_shared<PrepareCommand>();
  options->prepare.threads = all_cores();
  std::vector<std::string> ways = pieces_ways();
  ways.insert(ways.begin(), "auto");
  command
      ->add_option(
          "MESH", options->meshes,
          "Mesh files: OBJ, STL, PLY, OFF, glTF, GLB, COLLADA; several are pieces of one part. STEP where "
          "tactum-step is installed")
      ->required();
  command->add_option("-o,--output", options->part, "The part file to write")->required();
  command->add_option(
      "--fit", options->fit,
      "The smallest play that is to be felt, with its unit (20um): facets of a STEP file are within a "
      "twentieth of it");
  CLI::Option* units = command
                           ->add_option("--units", options->prepare.unit,
                                        "The unit of the mesh's numbers; auto guesses and says why")
                           ->check(CLI::IsMember({"auto", "m", "cm", "mm", "inch"}));
  command->add_option("--scale", options->prepare.scale, "Metres per unit of the mesh's numbers")
      ->check(CLI::PositiveNumber)
      ->excludes(units);
  command
      ->add_option("--pieces", options->prepare.pieces,
                   "How to cut the mesh into pieces; auto chooses and says why")
      ->check(CLI::IsMember(ways));
  command
      ->add_option("--close-holes", options->prepare.close_holes,
                   "Close holes that have at most so many edges")
      ->check(CLI::Range(0, 256));
  command
      ->add_option("--density", options->prepare.density_kg_per_m3,
                   "The density of the part [kg/m^3]; 1000 by default")
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--threads", options->prepare.threads,
                   "How many threads prepare the part; by default as many as there are cores")
      ->check(CLI::Range(1, 1024));
  command->add_option("--name", options->prepare.name, "The name of the part; by default that of the file");
  command->add_option("--cache", options->cache,
                      "The folder of parts prepared before; by default ~/.cache/tactum");
  command->add_flag("--no-cache", options->no_cache,
                    "Neither look for the part in that folder nor keep it there");
  command->add_option("--json", options->json, "Write the report to this file (- for stdout)");
  command->callback([options] {
    if (options->prepare.name.empty())
      options->prepare.name = std::filesystem::path(options->meshes.front()).stem().string();
    run(*options);
  });
}

}  // namespace tactum
