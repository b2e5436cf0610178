#include "part_text.h"

#include <fmt/format.h>

namespace tactum {
namespace {

using Json = nlohmann::ordered_json;

/// The report of the file; null when it holds none that can be read.
Json report_of(const PartFile& file) {
  Json report = Json::parse(file.report, nullptr, false);
  return report.is_object() ? report : Json();
}

/// A member of an object of the report, null when it is not there.
Json member(const Json& object, const char* first, const char* second = nullptr) {
  const auto found = object.find(first);
  if (found == object.end()) return {};
  return second == nullptr ? *found : member(*found, second);
}

double number(const Json& value) { return value.is_number() ? value.get<double>() : 0.0; }
long count(const Json& value) { return value.is_number() ? value.get<long>() : 0; }
std::string text(const Json& value) { return value.is_string() ? value.get<std::string>() : std::string(); }

/// "1 triangle", "2 triangles".
std::string counted(const Json& value, const char* one, const char* many) {
  return fmt::format("{} {}", count(value), count(value) == 1 ? one : many);
}

std::string sentences(const Json& notes, const char* label) {
  std::string out;
  if (!notes.is_array()) return out;
  for (const Json& note : notes) {
    out += fmt::format("{: <12}{}\n", label, text(member(note, "sentence")));
    label = "";
  }
  return out;
}

std::string pieces_line(const Json& pieces) {
  const std::string reason = text(member(pieces, "reason"));
  if (member(pieces, "solid") == Json(true)) {
    return fmt::format("pieces      {} solid, {:.1f} vertices in the mean, {} at most: {}\n",
                       count(member(pieces, "count")), number(member(pieces, "vertices_mean")),
                       count(member(pieces, "vertices_most")), reason);
  }
  return fmt::format("pieces      surface of {} in {}, thinnest {:.2g} of its side: {}\n",
                     counted(member(pieces, "count"), "triangle", "triangles"),
                     counted(member(pieces, "patches"), "flat patch", "flat patches"),
                     number(member(pieces, "thinnest_height_over_side")), reason);
}

}  // namespace

std::string unit_warning(const std::string& prepare, const PartFile& file) {
  const Json unit = member(report_of(file), "unit");
  if (!unit.is_object() || member(unit, "certain") != Json(false)) return {};
  return fmt::format("THE UNIT IS A GUESS: {}? {} If it is wrong: {} --units mm (or m, cm, inch)\n",
                     text(member(unit, "name")), text(member(unit, "reason")), prepare);
}

std::string describe_part(const std::string& path, const PartFile& file) {
  const Part& part = file.part;
  const Json report = report_of(file);
  const Vec3 side = bounds(part.surface.vertices).half() * 2.0;
  std::string out = fmt::format("{}: part \"{}\"\n", path, part.name);
  out += fmt::format("size        {:.6g} x {:.6g} x {:.6g} m, diagonal {:.6g} m\n", side.x(), side.y(),
                     side.z(), part.size);
  out += fmt::format("mass        {:.6g} kg at {:g} kg/m^3, volume {:.9g} m^3, centre {:.6g} {:.6g} {:.6g}\n",
                     part.mass.mass, file.density_kg_per_m3, part.mass.volume, file.origin.x(),
                     file.origin.y(), file.origin.z());
  if (!part.mass.approximation.empty()) out += fmt::format("            {}\n", part.mass.approximation);
  if (report.is_null()) return out + fmt::format("pieces      {}\n", part.pieces.size());
  out += fmt::format("unit        {}: {}\n", text(member(report, "unit", "name")),
                     text(member(report, "unit", "reason")));
  const Json mesh = member(report, "mesh");
  out += fmt::format("mesh        {}, {}, {} closed; edges: {} open, {} non-manifold, {} convex, {} reflex\n",
                     counted(member(mesh, "triangles"), "triangle", "triangles"),
                     counted(member(mesh, "components"), "component", "components"),
                     count(member(mesh, "closed_components")), count(member(mesh, "boundary_edges")),
                     count(member(mesh, "non_manifold_edges")), count(member(mesh, "convex_edges")),
                     count(member(mesh, "reflex_edges")));
  out += sentences(member(report, "repaired"), "repaired");
  out += sentences(member(report, "left"), "left");
  out += pieces_line(member(report, "pieces"));
  const Json verified = member(report, "verification");
  out += fmt::format(
      "verified    mesh to part {:.2g} m ({} samples), part to mesh {:.2g} m ({}): {:.2g} of the size\n",
      number(member(verified, "mesh_to_part_m")), count(member(verified, "mesh_samples")),
      number(member(verified, "part_to_mesh_m")), count(member(verified, "part_samples")),
      number(member(verified, "deviation_over_size")));
  return out;
}

nlohmann::ordered_json part_json(const std::string& path, const PartFile& file) {
  Json json = {{"file", path}, {"name", file.part.name}, {"size_m", file.part.size}};
  json["density_kg_per_m3"] = file.density_kg_per_m3;
  json["origin_m"] = {file.origin.x(), file.origin.y(), file.origin.z()};
  json["report"] = report_of(file);
  return json;
}

}  // namespace tactum
