#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "part_text.h"
#include "tactum/geometry/mesh_report.h"
#include "tactum/mesh/deviation.h"
#include "tactum/mesh/make_part.h"
#include "tactum/mesh/mesh_import.h"
#include "view_part.h"

/// `tactum inspect FILE...`: the contents of a mesh file and its faults; the construction of a prepared part.

namespace tactum {
namespace {

struct InspectOptions {
  std::vector<std::string> files;
  std::string json;    ///< file to write, "-" for stdout
  double scale = 1.0;  ///< metres per unit of the files [m]
  bool view = false;
  int port = 0;
};

struct Inspection {
  std::string file;
  ImportedMesh mesh;
  MeshReport report;
  UnitGuess unit;
  double scale = 1.0;            ///< metres per unit that the report and the part were made with [m]
  int exact_boundary_edges = 0;  ///< when only equal coordinates are joined
  Result<Part> part = Error{};   ///< the part that a scene would make of it
  Deviation deviation;           ///< ... and how far that is from the file
};

/// CAD files come in hundreds of groups; so many are named.
constexpr std::size_t kNamedGroups = 12;

Inspection inspected(const std::string& file, ImportedMesh mesh, double scale) {
  Inspection out;
  out.file = file;
  out.report = report_mesh(mesh.mesh);
  out.exact_boundary_edges = report_mesh(mesh.mesh, 0.0).boundary_edges;
  Aabb in_file_units = out.report.box;
  in_file_units.min /= scale;
  in_file_units.max /= scale;
  out.unit = unit_of(mesh.report, in_file_units);
  out.scale = scale;
  out.part = part_from_mesh(mesh.mesh, {.name = std::filesystem::path(file).filename().string()});
  if (out.part) out.deviation = surface_deviation(mesh.mesh, *out.part);
  out.mesh = std::move(mesh);
  return out;
}

/// What the lines above it take the numbers of the file for, where the likelier unit is another one; else
/// nothing.
std::string in_the_likely_unit(const Inspection& of) {
  const double factor = of.unit.metres_per_unit / of.scale;
  if (of.mesh.report.in_metres || factor == 1.0) return {};
  const Vec3 side = factor * (of.report.box.max - of.report.box.min);
  return fmt::format(
      "The lines above take the numbers of the file as {}; in {} it is {:.6g} x {:.6g} x {:.6g} m large{} "
      "(--scale {:g}).\n",
      of.scale == 1.0 ? "metres" : fmt::format("units of {:g} m", of.scale), of.unit.name, side.x(), side.y(),
      side.z(),
      of.report.balanced ? fmt::format(", its volume {:.6g} m^3", of.report.volume * factor * factor * factor)
                         : "",
      of.unit.metres_per_unit);
}

std::string as_text(const Inspection& of) {
  std::string text = fmt::format("{}: {}\n", of.file, of.mesh.report.format);
  if (of.mesh.groups.size() > 1) {
    text += fmt::format("{} objects:", of.mesh.groups.size());
    for (std::size_t i = 0; i < std::min(kNamedGroups, of.mesh.groups.size()); ++i)
      text += fmt::format(" '{}' ({})", of.mesh.groups[i].name, of.mesh.groups[i].triangle_count);
    text += of.mesh.groups.size() > kNamedGroups ? " ...\n" : "\n";
  }
  text += describe(of.report);
  if (of.exact_boundary_edges != of.report.boundary_edges) {
    text += fmt::format("{} boundary edges if only equal coordinates are joined\n", of.exact_boundary_edges);
  }
  for (const std::string& remark : of.mesh.report.remarks) text += remark + "\n";
  text += fmt::format("unit: {}{} {}\n", of.unit.name, of.mesh.report.in_metres ? ":" : "?", of.unit.reason);
  text += in_the_likely_unit(of);
  if (!of.part) return text + fmt::format("as a part: {}\n", of.part.error().message());
  return text +
         fmt::format("as a part: {}; deviation {:.2g} of the size ({} samples of the mesh, {} of the part)\n",
                     of.part->notes.pieces, of.deviation.largest() / of.deviation.size,
                     of.deviation.mesh_samples, of.deviation.part_samples);
}

nlohmann::json part_json(const Inspection& of) {
  if (!of.part) return {{"error", of.part.error().message()}};
  return {{"way", of.part->notes.pieces},
          {"pieces", of.part->pieces.size()},
          {"mesh_to_part_m", of.deviation.mesh_to_part},
          {"part_to_mesh_m", of.deviation.part_to_mesh},
          {"deviation_over_size", of.deviation.largest() / of.deviation.size}};
}

nlohmann::json vector_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

nlohmann::json as_json(const Inspection& of) {
  const MeshReport& r = of.report;
  nlohmann::json groups = nlohmann::json::array();
  for (const MeshGroup& g : of.mesh.groups)
    groups.push_back({{"name", g.name}, {"triangles", g.triangle_count}});
  return {{"file", of.file},
          {"format", of.mesh.report.format},
          {"groups", groups},
          {"triangles", r.triangles},
          {"vertices", r.vertices},
          {"components", r.components},
          {"closed", r.closed},
          {"manifold", r.manifold()},
          {"oriented", r.oriented},
          {"convex", r.convex},
          {"boundary_edges", r.boundary_edges},
          {"boundary_edges_exact", of.exact_boundary_edges},
          {"non_manifold_edges", r.non_manifold_edges},
          {"misoriented_edges", r.misoriented_edges},
          {"convex_edges", r.convex_edges},
          {"reflex_edges", r.reflex_edges},
          {"degenerate_index", r.index_degenerate},
          {"degenerate_area", r.zero_area},
          {"duplicate_triangles", r.duplicate_triangles},
          {"volume_m3", r.volume},
          {"volume_known", r.balanced},
          {"area_m2", r.area},
          {"box_min_m", vector_json(r.box.min)},
          {"box_max_m", vector_json(r.box.max)},
          {"unit_guess",
           {{"name", of.unit.name},
            {"metres_per_unit", of.unit.metres_per_unit},
            {"reason", of.unit.reason},
            {"certain", of.unit.certain}}},
          {"part", part_json(of)},
          {"remarks", of.mesh.report.remarks}};
}

/// A prepared part as it is, or what a mesh would become without repairs.
Result<Part> part_of(const InspectOptions& options) {
  const std::string& file = options.files[0];
  if (is_part_file(file)) {
    Result<PartFile> part = load_part(file);
    if (!part) return part.error();
    return std::move(part->part);
  }
  const Result<ImportedMesh> mesh = import_mesh(file, {.scale = options.scale});
  if (!mesh) return mesh.error();
  return part_from_mesh(mesh->mesh, {.name = std::filesystem::path(file).filename().string()});
}

void view(const InspectOptions& options) {
  const Result<Part> part = part_of(options);
  if (!part) fail(part.error());
  view_part(*part, options.port);
}

/// Prints the file unless JSON goes to stdout.
Result<nlohmann::ordered_json> inspect(const std::string& file, const InspectOptions& options) {
  if (is_part_file(file)) {
    const Result<PartFile> part = load_part(file);
    if (!part) return part.error();
    if (options.json != "-") fmt::print("{}\n", describe_part(file, *part));
    return part_json(file, *part);
  }
  Result<ImportedMesh> mesh = import_mesh(file, {.scale = options.scale});
  if (!mesh) return mesh.error();
  const Inspection inspection = inspected(file, std::move(*mesh), options.scale);
  if (options.json != "-") fmt::print("{}\n", as_text(inspection));
  return nlohmann::ordered_json(as_json(inspection));
}

void run(const InspectOptions& options) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  bool failed = false;
  for (const std::string& file : options.files) {
    Result<nlohmann::ordered_json> one = inspect(file, options);
    if (!one) {
      failed = true;
      fmt::print(stderr, "tactum: {}\n", one.error().message());
    }
    all.push_back(one ? std::move(*one)
                      : nlohmann::ordered_json{{"file", file}, {"error", one.error().message()}});
  }
  const std::string text = all.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
  if (options.json == "-") {
    fmt::print("{}", text);
  } else if (!options.json.empty()) {
    std::ofstream file(options.json, std::ios::binary);
    if (!(file << text) || !file.flush()) {
      fail(Error{"the file cannot be written", "", "a writable place", options.json});
    }
  }
  if (failed) throw CLI::RuntimeError(1);
  if (options.view) view(options);
}

}  // namespace

void add_inspect(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "inspect", "Say what is in mesh files and prepared parts, and what is wrong with them");
  auto options = std::make_shared<InspectOptions>();
  command
      ->add_option("FILE", options->files,
                   "Mesh files (OBJ, STL, PLY, OFF, glTF, GLB, COLLADA) and prepared parts")
      ->required();
  command->add_option("--json", options->json, "Write the reports to this file (- for stdout)");
  command->add_option("--scale", options->scale, "Metres per unit of the numbers in the files")
      ->check(CLI::PositiveNumber);
  command->add_flag("--view", options->view, "Serve a page that shows the first of them, until interrupted");
  command->add_option("--port", options->port, "The port of the page; by default one that is free")
      ->check(CLI::Range(1, 65535))
      ->needs("--view");
  command->callback([options] { run(*options); });
}

}  // namespace tactum
