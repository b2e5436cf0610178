#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tactum/mesh/prepare_part.h"

/// The numbers of a preparation as JSON, kept in the part file.

namespace tactum::inline v0_1 {
namespace {

using Json = nlohmann::ordered_json;

Json vector(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

Json notes_of(const std::vector<RepairNote>& notes, bool mended) {
  Json list = Json::array();
  for (const RepairNote& note : notes) {
    if (note.mended != mended) continue;
    list.push_back({{"kind", note.kind},
                    {"count", note.count},
                    {"sentence", note.sentence()},
                    {"first_triangle", note.triangle},
                    {"place_m", vector(note.place)}});
  }
  return list;
}

/// How regular the pieces are: for solids their vertices and volumes, for surfaces their thinnest triangle.
Json pieces_of(const PrepareReport& report, const Part& part) {
  const bool solid = !part.pieces.empty() && !part.pieces.front().flat;
  Json out = {{"way", report.pieces},
              {"reason", report.pieces_reason},
              {"solid", solid},
              {"count", solid ? part.pieces.size() : part.surface.triangles.size()},
              {"patches", part.groups.count}};
  if (solid) {
    int most = 0;
    long sum = 0;
    for (const Polytope& piece : part.pieces) {
      most = std::max(most, piece.counts[0]);
      sum += piece.counts[0];
    }
    out["vertices_mean"] = static_cast<double>(sum) / static_cast<double>(part.pieces.size());
    out["vertices_most"] = most;
    return out;
  }
  double thinnest = 1.0;
  for (const Triangle& t : part.surface.triangles) {
    const Vec3& a = part.surface.vertices[t[0]];
    const Vec3& b = part.surface.vertices[t[1]];
    const Vec3& c = part.surface.vertices[t[2]];
    const double longest_sq = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
    thinnest = std::min(thinnest, (b - a).cross(c - a).norm() / longest_sq);
  }
  out["thinnest_height_over_side"] = thinnest;
  return out;
}

Json verification_of(const Verification& found) {
  const Deviation& d = found.deviation;
  Json out = {{"mesh_to_part_m", d.mesh_to_part},
              {"part_to_mesh_m", d.part_to_mesh},
              {"deviation_over_size", d.largest() / d.size},
              {"mesh_samples", d.mesh_samples},
              {"part_samples", d.part_samples},
              {"samples_on_cuts", d.inner_samples},
              {"overlapping_pairs", found.overlaps.pairs},
              {"pieces_area_m2", found.pieces_area}};
  if (found.mesh_area >= 0.0) out["mesh_area_m2"] = found.mesh_area;
  if (found.mesh_volume >= 0.0) {
    out["mesh_volume_m3"] = found.mesh_volume;
    out["pieces_volume_m3"] = found.pieces_volume;
  }
  return out;
}

}  // namespace

std::string to_json(const PrepareReport& report, const Part& part) {
  const MeshReport& mesh = report.mesh;
  int closed = 0;
  for (const MeshComponent& component : report.components) closed += component.closed ? 1 : 0;
  const Mat3& inertia = part.mass.inertia;
  const Json out = {
      {"format", report.format},
      {"unit",
       {{"name", report.unit.name},
        {"metres_per_unit", report.unit.metres_per_unit},
        {"reason", report.unit.reason},
        {"certain", report.unit.certain}}},
      {"repaired", notes_of(report.notes, true)},
      {"left", notes_of(report.notes, false)},
      {"mesh",
       {{"triangles", mesh.triangles},
        {"vertices", mesh.vertices},
        {"components", report.components.size()},
        {"closed_components", closed},
        {"closed", mesh.closed},
        {"boundary_edges", mesh.boundary_edges},
        {"non_manifold_edges", mesh.non_manifold_edges},
        {"convex_edges", mesh.convex_edges},
        {"reflex_edges", mesh.reflex_edges},
        {"area_m2", mesh.area},
        {"box_min_m", vector(mesh.box.min)},
        {"box_max_m", vector(mesh.box.max)}}},
      {"pieces", pieces_of(report, part)},
      {"mass",
       {{"volume_m3", part.mass.volume},
        {"mass_kg", part.mass.mass},
        {"inertia_kg_m2", {vector(inertia.row(0)), vector(inertia.row(1)), vector(inertia.row(2))}},
        {"approximation", part.mass.approximation}}},
      {"verification", verification_of(report.verification)}};
  return out.dump(1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace tactum::inline v0_1
