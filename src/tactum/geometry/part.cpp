#include "tactum/geometry/part.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tactum/base/tolerances.h"
#include "tactum/geometry/hull.h"
#include "tactum/geometry/mesh_edges.h"
#include "tactum/geometry/mesh_report.h"
#include "tactum/geometry/weld.h"

namespace tactum {
namespace {

/// The faces of a polytope, cut into triangles, behind `surface`.
void append_faces(const Polytope& piece, TriangleMesh& surface) {
  const int base = static_cast<int>(surface.vertices.size());
  surface.vertices.insert(surface.vertices.end(), piece.vertices.begin(), piece.vertices.end());
  for (const Polytope::Face& face : piece.faces) {
    const int* loop = piece.face_vertices.data() + face.first;
    for (int i = 1; i + 1 < face.count; ++i) {
      surface.triangles.push_back({base + loop[0], base + loop[i], base + loop[i + 1]});
    }
  }
}

/// Of bodies joined rigidly; where they overlap, the overlap counts twice.
MassProperties joined(const std::vector<MassProperties>& bodies) {
  MassProperties sum;
  for (const MassProperties& body : bodies) {
    sum.volume += body.volume;
    sum.mass += body.mass;
    sum.center += body.mass * body.center;
  }
  sum.center /= sum.mass;
  for (const MassProperties& body : bodies) {
    const Vec3 r = body.center - sum.center;
    sum.inertia += body.inertia + body.mass * (r.squaredNorm() * Mat3::Identity() - r * r.transpose());
  }
  return sum;
}

Result<void> check_options(const PartOptions& options) {
  const bool sound = std::isfinite(options.scale) && options.scale > 0.0 &&
                     std::isfinite(options.density_kg_per_m3) && options.density_kg_per_m3 > 0.0;
  if (sound) return {};
  return Error{"the part cannot be built",
               fmt::format("scale {}, density {}", options.scale, options.density_kg_per_m3),
               "numbers above zero", options.name};
}

/// What follows from surface, pieces and mass.
void complete(Part& part) {
  part.size = bounds(part.surface.vertices).diagonal();
  for (const Vec3& vertex : part.surface.vertices) {
    part.radius = std::max(part.radius, (vertex - part.mass.center).norm());
  }
  std::vector<Aabb> boxes;
  boxes.reserve(part.pieces.size());
  for (const Polytope& piece : part.pieces) boxes.push_back(bounds(piece.vertices));
  part.hierarchy = Bvh(boxes);
  if (!part.mass.approximation.empty()) part.remarks.push_back(part.mass.approximation);
}

Error unusable(const PartOptions& options, const std::string& found, const std::string& expected) {
  return Error{"the part cannot be built", found, expected, options.name};
}

/// The edge where the surface is most concave, if it is so by more than single-precision files explain.
Result<void> check_convex(const TriangleMesh& mesh, const std::string& name, const PartOptions& options) {
  const MeshReport report = report_mesh(mesh);
  if (!report.closed || !report.oriented || report.components != 1) {
    return unusable(
        options,
        fmt::format("piece '{}' with {} boundary, {} non-manifold and {} misoriented edges in {} components",
                    name, report.boundary_edges, report.non_manifold_edges, report.misoriented_edges,
                    report.components),
        "a closed surface of one component for each piece");
  }
  double worst = tolerances::kCoplanarMeshOffset * report.box.diagonal();
  const HalfEdge* offending = nullptr;
  const std::vector<HalfEdge> sides = sorted_half_edges(mesh);
  for_each_edge(sides, [&](const HalfEdge* first, const HalfEdge*) {
    const Triangle& t = mesh.triangles[first[0].triangle];
    const Vec3& a = mesh.vertices[t[0]];
    if (has_no_area(a, mesh.vertices[t[1]], mesh.vertices[t[2]])) return;
    const Vec3 normal = (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a).normalized();
    const Vec3& far = mesh.vertices[mesh.triangles[first[1].triangle][(first[1].corner + 2) % 3]];
    const double height = normal.dot(far - a);
    if (height <= worst) return;
    worst = height;
    offending = first;
  });
  if (offending == nullptr) return {};
  const Vec3& p = mesh.vertices[offending->low];
  const Vec3& q = mesh.vertices[offending->high];
  return unusable(
      options,
      fmt::format(
          "piece '{}' bent inward by {:.3g} m at the edge ({:.6g} {:.6g} {:.6g}) - ({:.6g} {:.6g} {:.6g})",
          name, worst, p.x(), p.y(), p.z(), q.x(), q.y(), q.z()),
      "convex pieces");
}

/// The triangles of one group, scaled and welded.
TriangleMesh group_mesh(const ImportedMesh& mesh, const MeshGroup& group, double scale) {
  TriangleMesh part;
  for (int i = 0; i < group.triangle_count; ++i) {
    const Triangle& t = mesh.mesh.triangles[group.first_triangle + i];
    const int first = static_cast<int>(part.vertices.size());
    for (int corner : t) part.vertices.emplace_back(scale * mesh.mesh.vertices[corner]);
    part.triangles.push_back({first, first + 1, first + 2});
  }
  return weld(part).mesh;
}

/// One flat piece for each triangle that has an area.
void add_surface_pieces(Part& part) {
  const std::vector<int> groups = coplanar_groups(part.surface);
  part.one_sided = true;
  std::vector<Triangle> kept;  // piece i is triangle i of the surface
  const std::size_t given = part.surface.triangles.size();
  for (std::size_t i = 0; i < part.surface.triangles.size(); ++i) {
    const Triangle t = part.surface.triangles[i];
    Result<Polytope> piece =
        flat_polygon({part.surface.vertices[t[0]], part.surface.vertices[t[1]], part.surface.vertices[t[2]]});
    if (!piece) continue;
    kept.push_back(t);
    part.piece_normal.push_back(piece->faces[0].normal);
    part.surface_group.push_back(groups[i]);
    part.pieces.push_back(std::move(*piece));
  }
  part.surface.triangles = std::move(kept);
  part.group_count = groups.empty() ? 0 : 1 + *std::max_element(groups.begin(), groups.end());
  if (const std::size_t thin = given - part.pieces.size(); thin > 0) {
    part.remarks.push_back(
        fmt::format("{} triangles are too thin to be pieces; their neighbours' edges cover them.", thin));
  }
}

void tell_repairs(const WeldReport& weld_report, const MeshReport& report, Part& part) {
  const auto tell = [&part](std::size_t count, const char* text) {
    if (count > 0) part.remarks.push_back(fmt::format("{} {}.", count, text));
  };
  tell(weld_report.index_degenerate.size(), "triangles with two equal corners were dropped");
  tell(weld_report.zero_area.size(), "triangles without area were dropped");
  tell(weld_report.duplicates.size(), "triangles that stood twice were dropped");
  tell(static_cast<std::size_t>(report.boundary_edges), "edges are open: the surface has holes");
  tell(static_cast<std::size_t>(report.misoriented_edges), "edges join triangles that face opposite ways");
}

}  // namespace

Result<Part> part_from_clouds(const std::vector<std::vector<Vec3>>& clouds, const PartOptions& options) {
  if (Result<void> sound = check_options(options); !sound) return sound.error();
  if (clouds.empty()) return unusable(options, "no piece", "at least one");
  Part part;
  part.name = options.name;
  std::vector<MassProperties> masses;
  for (std::size_t i = 0; i < clouds.size(); ++i) {
    std::vector<Vec3> points = clouds[i];
    for (Vec3& point : points) point *= options.scale;
    Result<Polytope> piece = convex_hull(points);
    if (!piece)
      return unusable(options, fmt::format("piece {}: {}", i, piece.error().message()),
                      "points that span a solid");
    if (piece->flat)
      return unusable(options, fmt::format("piece {} with all points in a plane", i),
                      "points that span a solid");
    TriangleMesh faces;
    append_faces(*piece, faces);
    masses.push_back(mass_properties_or_hull(faces, options.density_kg_per_m3));
    append_faces(*piece, part.surface);
    part.surface_group.push_back(static_cast<int>(i));
    part.pieces.push_back(std::move(*piece));
  }
  part.group_count = static_cast<int>(part.pieces.size());
  part.mass = joined(masses);
  complete(part);
  return part;
}

Result<Part> part_from_convex_groups(const ImportedMesh& mesh, const PartOptions& options) {
  if (Result<void> sound = check_options(options); !sound) return sound.error();
  std::vector<std::vector<Vec3>> clouds;
  for (const MeshGroup& group : mesh.groups) {
    const TriangleMesh piece = group_mesh(mesh, group, options.scale);
    if (Result<void> convex = check_convex(piece, group.name, options); !convex) return convex.error();
    clouds.push_back(piece.vertices);
  }
  PartOptions scaled = options;
  scaled.scale = 1.0;
  return part_from_clouds(clouds, scaled);
}

Result<Part> part_from_mesh(const TriangleMesh& mesh, const PartOptions& options) {
  if (Result<void> sound = check_options(options); !sound) return sound.error();
  TriangleMesh scaled = mesh;
  for (Vec3& vertex : scaled.vertices) vertex *= options.scale;
  MeshReport report = report_mesh(scaled);
  Part part;
  part.name = options.name;
  if (report.closed && report.oriented && report.volume < 0.0) {
    for (Triangle& t : scaled.triangles) std::swap(t[1], t[2]);
    part.remarks.emplace_back("The normals point inward: the surface was turned round.");
    report = report_mesh(scaled);
  }
  part.mass = mass_properties_or_hull(scaled, options.density_kg_per_m3);
  WeldedMesh welded = weld(scaled, {.drop_zero_area = true, .drop_duplicates = true});
  part.surface = std::move(welded.mesh);
  tell_repairs(welded.report, report, part);
  if (report.convex) {
    if (Result<Polytope> solid = convex_hull(part.surface.vertices); solid && !solid->flat) {
      part.pieces.push_back(std::move(*solid));
      part.surface_group.push_back(0);
      part.group_count = 1;
    }
  }
  if (part.pieces.empty()) add_surface_pieces(part);
  if (part.pieces.empty()) return unusable(options, "no triangle with an area", "a surface");
  complete(part);
  return part;
}

}  // namespace tactum
