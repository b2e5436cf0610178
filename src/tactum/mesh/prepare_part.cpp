#include "tactum/mesh/prepare_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "tactum/base/tolerances.h"
#include "tactum/mesh/make_part.h"
#include "tactum/mesh/prepare_pieces.h"
#include "tactum/repair/two_sided.h"

namespace tactum::inline v0_1 {
namespace {

// Beyond these a hand can feel nothing, and the unit is wrong more likely than the part.
constexpr double kSmallestPart_m = 1e-6;
constexpr double kLargestPart_m = 1e5;

Error refused(const std::string& found, const std::string& expected, const PrepareOptions& options) {
  return {"the mesh cannot be prepared", found, expected, options.name};
}

Result<UnitGuess> wanted_unit(const ImportReport& report, const Aabb& box, const PrepareOptions& options) {
  if (options.scale != 0.0) {
    if (!(std::isfinite(options.scale) && options.scale > 0.0))
      return refused(fmt::format("the scale {:g}", options.scale), "a number above zero", options);
    return UnitGuess{fmt::format("units of {:g} m", options.scale), options.scale, "As asked for."};
  }
  if (options.unit == "auto") return unit_of(report, box);
  for (const UnitGuess& unit : {UnitGuess{"metres", 1.0, "m"}, UnitGuess{"centimetres", 0.01, "cm"},
                                UnitGuess{"millimetres", 0.001, "mm"}, UnitGuess{"inches", 0.0254, "inch"}}) {
    if (options.unit == unit.reason) return UnitGuess{unit.name, unit.metres_per_unit, "As asked for."};
  }
  return refused(fmt::format("the unit \"{}\"", options.unit), "auto, m, cm, mm or inch", options);
}

/// Faults with which no part can be made.
Result<void> check_usable(const RepairedMesh& repaired, const UnitGuess& unit,
                          const PrepareOptions& options) {
  if (repaired.mesh.triangles.empty())
    return refused("no triangle with an area", "a surface or a solid", options);
  const double size = bounds(repaired.mesh.vertices).diagonal();
  if (!(size >= kSmallestPart_m && size <= kLargestPart_m)) {
    return refused(fmt::format("a size of {:.3g} m with the mesh in {}", size, unit.name),
                   "a micrometre to a hundred kilometres: give the unit, or scale the mesh", options);
  }
  const auto encloses_nothing = [](const MeshComponent& c) { return c.empty_inside(); };
  if (std::all_of(repaired.components.begin(), repaired.components.end(), encloses_nothing)) {
    const Vec3 place = repaired.components.front().box.center();
    return refused(fmt::format("a closed surface that encloses no volume, about {:.6g} {:.6g} {:.6g} m",
                               place.x(), place.y(), place.z()),
                   "a solid, or an open surface", options);
  }
  return {};
}

/// The mesh as given but for walls inside it, and the triangles that close its holes.
TriangleMesh reference_of(const TriangleMesh& given, const RepairedMesh& repaired) {
  TriangleMesh reference;
  reference.vertices = given.vertices;
  for (int t = 0; t < static_cast<int>(given.triangles.size()); ++t)
    if (!std::binary_search(repaired.walls.begin(), repaired.walls.end(), t))
      reference.triangles.push_back(given.triangles[t]);
  for (std::size_t t = 0; t < repaired.source.size(); ++t) {
    if (repaired.source[t] >= 0) continue;
    const int first = static_cast<int>(reference.vertices.size());
    for (int corner : repaired.mesh.triangles[t])
      reference.vertices.push_back(repaired.mesh.vertices[corner]);
    reference.triangles.push_back({first, first + 1, first + 2});
  }
  return reference;
}

/// One method, from the mesh to the verdict.
struct Attempt {
  const PiecesInput& input;
  const TriangleMesh& reference;
  const PrepareProgress& progress;
  const PrepareOptions& options;
  double backs_area;  ///< that open surfaces add [m^2]

  Result<void> run(const PieceMethod& method, PartFile& file, PrepareReport& report) const {
    progress("cutting into pieces", 0.3);
    const Result<Vec3> center = method.center(input);
    if (!center) return center.error();
    Result<Part> part = method.make(input, *center);
    if (!part) return part.error();
    progress("verifying", 0.6);
    const bool solid = std::any_of(part->pieces.begin(), part->pieces.end(),
                                   [](const Polytope& piece) { return !piece.flat; });
    const double area = solid && part->pieces.size() > 1 ? -1.0 : input.report.area + backs_area;
    report.verification = verify_part(reference, *part, *center, solid ? method.volume(input) : -1.0, area,
                                      options.area_samples, options.threads);
    if (Result<void> passed = verdict_on(report.verification, input.options.name); !passed) return passed;
    file.part = std::move(*part);
    file.origin = *center;
    report.pieces = method.name;
    return {};
  }
};

/// The wanted method, or the first that suits and passes; the reason lists the outcome of the others.
Result<void> make_pieces(const Attempt& attempt, PartFile& file, PrepareReport& report) {
  const PrepareOptions& options = attempt.options;
  std::string tried;
  for (const PieceMethod& method : all_piece_methods()) {
    if (options.pieces != "auto" && options.pieces != method.name) continue;
    const std::string reason = options.pieces == "auto" ? method.suits(attempt.input) : "as asked for";
    if (reason.empty()) continue;
    const Result<void> done = attempt.run(method, file, report);
    if (done) {
      report.pieces_reason = tried + reason;
      return {};
    }
    if (options.pieces != "auto" || &method == &all_piece_methods().back()) return done;
    const Error& fault = done.error();
    tried += fmt::format("not {}, since {}{}; ", method.name, fault.found.empty() ? "" : "it has ",
                         fault.found.empty() ? fault.what : fault.found);
  }
  std::string known = "auto";
  for (const PieceMethod& method : all_piece_methods()) known += std::string(", ") + method.name;
  return refused("pieces \"" + options.pieces + "\"", known, options);
}

}  // namespace

std::vector<std::string> pieces_ways() {
  std::vector<std::string> names;
  for (const PieceMethod& method : all_piece_methods()) names.emplace_back(method.name);
  return names;
}

Verification verify_part(const TriangleMesh& reference, const Part& part, const Vec3& origin, double volume,
                         double area, int area_samples, int threads) {
  Verification out;
  out.deviation = surface_deviation(reference, part, origin, area_samples, threads);
  out.overlaps = overlapping_pieces(part, tolerances::kSurfaceDeviation * part.size);
  out.mesh_volume = volume;
  out.mesh_area = area;
  std::vector<int> piece;
  const TriangleMesh faces = faces_of(part, Vec3::Zero(), piece);
  double six_volumes = 0.0;
  for (const Triangle& t : faces.triangles) {
    const Vec3& a = faces.vertices[t[0]];
    const Vec3& b = faces.vertices[t[1]];
    const Vec3& c = faces.vertices[t[2]];
    six_volumes += a.dot(b.cross(c));
    out.pieces_area += 0.5 * (b - a).cross(c - a).norm();
  }
  if (volume >= 0.0) out.pieces_volume = six_volumes / 6.0;
  return out;
}

Result<void> verdict_on(const Verification& found, const std::string& name) {
  const Deviation& deviation = found.deviation;
  const double tolerance = tolerances::kSurfaceDeviation * deviation.size;
  const auto differs = [&](std::string what, std::string expected) {
    return Error{"the pieces are not the mesh", std::move(what), std::move(expected), name};
  };
  if (deviation.largest() > tolerance) {
    const bool on_mesh = deviation.mesh_to_part > deviation.part_to_mesh;
    const Vec3& at = on_mesh ? deviation.worst_on_mesh : deviation.worst_on_part;
    return differs(fmt::format("{} {:.3g} m away at {:.6g} {:.6g} {:.6g}",
                               on_mesh ? "a point of the mesh" : "a point of the pieces", deviation.largest(),
                               at.x(), at.y(), at.z()),
                   fmt::format("at most {:.3g}", tolerance));
  }
  if (found.overlaps.pairs > 0) {
    return differs(
        fmt::format("{} pairs of pieces that overlap, pieces {} and {} by {:.3g} m", found.overlaps.pairs,
                    found.overlaps.worst[0], found.overlaps.worst[1], found.overlaps.deepest),
        "pieces that touch at most");
  }
  if (found.mesh_volume >= 0.0 &&
      std::abs(found.pieces_volume - found.mesh_volume) > tolerance * found.pieces_area) {
    return differs(fmt::format("a volume of {:.12g} m^3 in the pieces", found.pieces_volume),
                   fmt::format("{:.12g}, as the mesh encloses", found.mesh_volume));
  }
  if (found.mesh_area >= 0.0 && std::abs(found.pieces_area - found.mesh_area) >
                                    tolerance * deviation.size + tolerance * found.mesh_area) {
    return differs(fmt::format("an area of {:.12g} m^2 in the pieces", found.pieces_area),
                   fmt::format("{:.12g}, as the mesh has", found.mesh_area));
  }
  return {};
}

Result<PartFile> prepare_part(ImportedMesh given, const PrepareOptions& options,
                              const PrepareProgress& progress) {
  const PrepareProgress silent = [](const char*, double) {};
  const PrepareProgress& show_progress = progress ? progress : silent;
  PrepareReport report;
  report.format = given.report.format;
  Aabb box;
  for (const Triangle& t : given.mesh.triangles)
    for (int corner : t) box.extend(given.mesh.vertices[corner]);
  const Result<UnitGuess> unit = wanted_unit(given.report, box, options);
  if (!unit) return unit.error();
  report.unit = *unit;

  show_progress("repairing", 0.1);
  for (Vec3& vertex : given.mesh.vertices) vertex *= report.unit.metres_per_unit;
  const RepairedMesh repaired =
      repair_mesh(given.mesh, {.close_holes = options.close_holes, .threads = options.threads});
  report.notes = repaired.notes;
  report.components = repaired.components;
  if (Result<void> usable = check_usable(repaired, report.unit, options); !usable) return usable.error();
  report.mesh = report_mesh(repaired.mesh);

  PartOptions part_options;
  part_options.name = options.name;
  part_options.density_kg_per_m3 = options.density_kg_per_m3;
  part_options.threads = options.threads;
  PartFile file;
  file.density_kg_per_m3 = options.density_kg_per_m3;
  const PiecesInput input{given, repaired, report.mesh, part_options};
  const TriangleMesh reference = reference_of(given.mesh, repaired);
  if (Result<void> made =
          make_pieces({input, reference, show_progress, options, open_area(repaired)}, file, report);
      !made)
    return made.error();
  for (const RepairNote& note : repaired.notes)
    if (!note.mended) file.part.notes.remarks.push_back(note.sentence());
  file.report = to_json(report, file.part);
  show_progress("writing", 0.95);
  return file;
}

}  // namespace tactum::inline v0_1
