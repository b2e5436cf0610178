#include "tactum/mesh/mesh_builder.h"

#include "tactum/mesh/polygon_split.h"

namespace tactum::inline v0_1::detail {

std::string in_quotes(std::string_view word) {
  constexpr std::size_t kLongest = 40;
  std::string text = "'";
  for (char c : word.substr(0, kLongest)) text += c >= ' ' && c <= '~' ? c : '?';
  return text + (word.size() > kLongest ? "...'" : "'");
}

Error MeshBuilder::error(const std::string& what, const std::string& found, const std::string& expected,
                         const std::string& place) const {
  return Error{what, found, expected, place.empty() ? file_ : file_ + ", " + place};
}

Result<void> MeshBuilder::add_vertex(const Vec3& point, const std::string& place) {
  if (!point.allFinite()) {
    return error("a vertex is not a point", "a coordinate that is not finite", "finite numbers", place);
  }
  if (point.cwiseAbs().maxCoeff() > options_.max_coordinate) {
    return error("a vertex is implausibly far away", std::to_string(point.cwiseAbs().maxCoeff()),
                 "coordinates up to " + std::to_string(options_.max_coordinate), place);
  }
  if (vertex_count() >= options_.max_vertices) {
    return error("too many vertices", "more than " + std::to_string(options_.max_vertices),
                 "at most that many (raise max_vertices)", place);
  }
  out_.mesh.vertices.push_back(point);
  return {};
}

Result<void> MeshBuilder::add_polygon(const std::vector<int>& corners, const std::string& place) {
  for (int corner : corners) {
    if (corner < 0 || corner >= vertex_count()) {
      return error("a face refers to a vertex that is not there",
                   "vertex " + std::to_string(corner) + " (from 0)",
                   "0 to " + std::to_string(vertex_count() - 1), place);
    }
  }
  if (corners.size() < 3) {
    ++out_.report.faces_dropped;
    return {};
  }
  if (out_.mesh.triangles.size() + corners.size() - 2 > static_cast<std::size_t>(options_.max_triangles)) {
    return error("too many triangles", "more than " + std::to_string(options_.max_triangles),
                 "at most that many (raise max_triangles)", place);
  }
  const SplitKind kind = split_polygon(out_.mesh.vertices, corners, out_.mesh.triangles);
  if (kind == SplitKind::kFailed) {
    return error("a concave face has too many corners", std::to_string(corners.size()),
                 "at most " + std::to_string(kMaxConcaveCorners), place);
  }
  out_.report.polygons_split += corners.size() > 3 ? 1 : 0;
  out_.report.concave_polygons += kind == SplitKind::kConcave ? 1 : 0;
  return {};
}

void MeshBuilder::begin_group(std::string_view name) {
  const int start = static_cast<int>(out_.mesh.triangles.size());
  if (!out_.groups.empty() && out_.groups.back().first_triangle == start) out_.groups.pop_back();
  out_.groups.push_back({std::string(name), start, 0});
}

void MeshBuilder::write_remarks() {
  ImportReport& report = out_.report;
  const auto say = [&report](int count, const char* one, const char* many) {
    if (count > 0) report.remarks.push_back(std::to_string(count) + (count == 1 ? one : many));
  };
  say(report.polygons_split, " face of more than three corners was cut into triangles.",
      " faces of more than three corners were cut into triangles.");
  say(report.concave_polygons, " of them was concave.", " of them were concave.");
  say(report.points_dropped, " point element was dropped.", " point elements were dropped.");
  say(report.lines_dropped, " line element was dropped.", " line elements were dropped.");
  say(report.faces_dropped, " face of fewer than three corners was dropped.",
      " faces of fewer than three corners were dropped.");
  say(report.unused_vertices, " vertex is used by no triangle.", " vertices are used by no triangle.");
}

Result<ImportedMesh> MeshBuilder::finish() {
  TriangleMesh& mesh = out_.mesh;
  if (mesh.triangles.empty()) {
    std::string found = std::to_string(vertex_count()) + " vertices";
    if (out_.report.lines_dropped > 0) found += ", " + std::to_string(out_.report.lines_dropped) + " lines";
    if (out_.report.points_dropped > 0)
      found += ", " + std::to_string(out_.report.points_dropped) + " points";
    return error("there is no surface in the file", found + " and no face", "at least one triangle");
  }
  const int triangle_count = static_cast<int>(mesh.triangles.size());
  if (out_.groups.empty() || out_.groups.front().first_triangle > 0) {
    out_.groups.insert(out_.groups.begin(), MeshGroup{"", 0, 0});
  }
  if (out_.groups.back().first_triangle == triangle_count) out_.groups.pop_back();
  for (std::size_t i = 0; i < out_.groups.size(); ++i) {
    const int end = i + 1 < out_.groups.size() ? out_.groups[i + 1].first_triangle : triangle_count;
    out_.groups[i].triangle_count = end - out_.groups[i].first_triangle;
  }
  std::vector<bool> used(mesh.vertices.size(), false);
  for (const Triangle& triangle : mesh.triangles) {
    for (int corner : triangle) used[corner] = true;
  }
  for (bool is_used : used) out_.report.unused_vertices += is_used ? 0 : 1;
  for (Vec3& vertex : mesh.vertices) vertex *= options_.scale;
  write_remarks();
  return std::move(out_);
}

}  // namespace tactum::inline v0_1::detail
