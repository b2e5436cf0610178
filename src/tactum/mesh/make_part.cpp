#include "tactum/mesh/make_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tactum/base/tolerances.h"
#include "tactum/geometry/coplanar_groups.h"
#include "tactum/geometry/hull.h"
#include "tactum/geometry/mesh_edges.h"
#include "tactum/geometry/mesh_report.h"
#include "tactum/geometry/weld.h"
#include "tactum/mesh/decomposition.h"
#include "tactum/repair/mesh_repair.h"
#include "tactum/repair/two_sided.h"

namespace tactum::inline v0_1 {
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

/// Sets the members that follow from surface, pieces and mass.
void complete(Part& part, int threads) {
  part.size = bounds(part.surface.vertices).diagonal();
  for (const Vec3& vertex : part.surface.vertices) {
    part.radius = std::max(part.radius, (vertex - part.mass.center).norm());
  }
  std::vector<Aabb> boxes;
  boxes.reserve(part.pieces.size());
  for (const Polytope& piece : part.pieces) boxes.push_back(bounds(piece.vertices));
  part.hierarchy = Bvh(boxes);
  const std::vector<int> groups = coplanar_groups(part.surface);
  part.tree = SurfaceTree(part.surface, groups, threads);
  if (part.is_surface()) part.groups.count = 1 + *std::max_element(groups.begin(), groups.end());
  find_true_surface(part);
  if (!part.mass.approximation.empty()) part.notes.remarks.push_back(part.mass.approximation);
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
  return repair_mesh(part).mesh;
}

/// So many pieces are allowed when a solid is wanted.
constexpr int kMostPieces = 512;

void add_solid_pieces(std::vector<Polytope> pieces, Part& part) {
  part.pieces = std::move(pieces);
  part.groups.count = static_cast<int>(part.pieces.size());
  for (int i = 0; i < part.groups.count; ++i) part.groups.of_piece.push_back(i);
}

/// `closed` is the welded mesh, with all its triangles.
Result<void> add_pieces(const TriangleMesh& closed, bool convex, const PartOptions& options, Part& part) {
  const bool chosen_here = options.pieces == PieceSource::kAuto;
  if (options.pieces == PieceSource::kGiven)
    return unusable(options, "given pieces asked for, and a mesh without groups", "a group for each piece");
  if (options.pieces != PieceSource::kSurface) {
    if (convex) {
      if (Result<Polytope> solid = convex_hull(part.surface.vertices); solid && !solid->flat) {
        add_solid_pieces({std::move(*solid)}, part);
        part.notes.pieces = "solid: convex as it is";
        return {};
      }
    }
    const int few = chosen_here ? kFewSolidPieces : kMostPieces;
    Result<SolidPieces> solid =
        solid_pieces(closed, options.most_solid_pieces > 0 ? options.most_solid_pieces : few);
    if (solid) {
      part.notes.pieces = fmt::format("solid: {} convex pieces from {} reflex edge{}", solid->pieces.size(),
                                      solid->reflex_edges, solid->reflex_edges == 1 ? "" : "s");
      add_solid_pieces(std::move(solid->pieces), part);
      return {};
    }
    if (!chosen_here) return unusable(options, solid.error().found, solid.error().expected);
    part.notes.pieces = fmt::format("surface: {} ({})", solid.error().what, solid.error().found);
  } else {
    part.notes.pieces = "surface: asked for";
  }
  return {};
}

/// One closed surface that faces outward, with nothing to repair.
bool is_sound(const MeshReport& report) {
  return report.closed && report.oriented && report.components == 1 && report.volume > 0.0 &&
         report.index_degenerate.empty() && report.zero_area.empty();
}

/// Triangles without area that repair could not mend.
void drop_without_area(RepairedMesh& repaired) {
  const TriangleMesh& mesh = repaired.mesh;
  std::size_t kept = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& corners = mesh.triangles[t];
    if (has_no_area(mesh.vertices[corners[0]], mesh.vertices[corners[1]], mesh.vertices[corners[2]]))
      continue;
    repaired.component[kept] = repaired.component[t];
    repaired.mesh.triangles[kept++] = corners;
  }
  repaired.mesh.triangles.resize(kept);
  repaired.component.resize(kept);
}

/// A mesh fit to be a part: `closed` with all triangles that keep the surface together, `surface` without
/// those that have no area, and with the backs of open surfaces.
struct FitMesh {
  TriangleMesh closed, surface;
  MeshReport report;
};

FitMesh fit_after_repair(RepairedMesh repaired, const MeshReport& report) {
  FitMesh fit{.closed = repaired.mesh, .surface = {}, .report = report};
  drop_without_area(repaired);
  fit.surface = with_backs(repaired);
  return fit;
}

FitMesh fit_for_part(const TriangleMesh& mesh, int threads, PartNotes& notes) {
  FitMesh fit{.closed = {}, .surface = {}, .report = report_mesh(mesh)};
  if (is_sound(fit.report)) {
    fit.closed = fit.surface = weld(mesh).mesh;
    return fit;
  }
  RepairedMesh repaired = repair_mesh(mesh, {.threads = threads});
  for (const RepairNote& note : repaired.notes) {
    if (note.kind != "joined_vertices") notes.remarks.push_back(note.sentence());
  }
  const MeshReport report = report_mesh(repaired.mesh);
  return fit_after_repair(std::move(repaired), report);
}

/// The options for points in metres that have been moved already.
PartOptions for_moved_points(const PartOptions& options) {
  PartOptions moved = options;
  moved.scale = 1.0;
  moved.about_center_of_mass = false;
  moved.origin.reset();
  return moved;
}

/// Pieces, surface and mass of a part of clouds; what follows from them is missing.
Result<Part> hulls_of(const std::vector<std::vector<Vec3>>& clouds, const PartOptions& options) {
  if (clouds.empty()) return unusable(options, "no piece", "at least one");
  Part part;
  part.name = options.name;
  std::vector<MassProperties> masses;
  std::vector<Polytope> pieces;
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
    pieces.push_back(std::move(*piece));
  }
  part.notes.pieces = fmt::format("given: {} convex pieces", pieces.size());
  add_solid_pieces(std::move(pieces), part);
  part.mass = joined(masses);
  return part;
}

Result<Part> clouds_about_center(const std::vector<std::vector<Vec3>>& clouds, const PartOptions& options) {
  std::vector<std::vector<Vec3>> moved = clouds;
  for (std::vector<Vec3>& cloud : moved)
    for (Vec3& point : cloud) point *= options.scale;
  PartOptions of_density_one = for_moved_points(options);
  of_density_one.density_kg_per_m3 = 1.0;
  const Result<Part> as_given = hulls_of(moved, of_density_one);
  if (!as_given) return as_given.error();
  const Vec3 center = options.origin.value_or(as_given->mass.center);
  for (std::vector<Vec3>& cloud : moved)
    for (Vec3& point : cloud) point -= center;
  Result<Part> part = part_from_clouds(moved, for_moved_points(options));
  if (part) part->origin = center;
  return part;
}

/// The corners of each group, scaled.
Result<std::vector<std::vector<Vec3>>> clouds_of_groups(const ImportedMesh& mesh,
                                                        const PartOptions& options) {
  std::vector<std::vector<Vec3>> clouds;
  for (const MeshGroup& group : mesh.groups) {
    TriangleMesh piece = group_mesh(mesh, group, options.scale);
    if (Result<void> convex = check_convex(piece, group.name, options); !convex) return convex.error();
    clouds.push_back(std::move(piece.vertices));
  }
  return clouds;
}

/// What follows from the mesh: mass, pieces and surface.
Result<Part> finished(Part part, FitMesh fit, const PartOptions& options) {
  part.name = options.name;
  if (options.about_center_of_mass || options.origin) {
    part.origin = options.origin ? *options.origin : mass_properties_or_hull(fit.closed, 1.0).center;
    for (TriangleMesh* moved : {&fit.closed, &fit.surface})
      for (Vec3& vertex : moved->vertices) vertex -= part.origin;
  }
  part.mass = mass_properties_or_hull(fit.closed, options.density_kg_per_m3);
  part.surface = std::move(fit.surface);
  if (Result<void> made = add_pieces(fit.closed, fit.report.convex, options, part); !made)
    return made.error();
  if (part.surface.triangles.empty()) return unusable(options, "no triangle with an area", "a surface");
  complete(part, options.threads);
  return part;
}

}  // namespace

Result<Part> part_from_clouds(const std::vector<std::vector<Vec3>>& clouds, const PartOptions& options) {
  if (Result<void> sound = check_options(options); !sound) return sound.error();
  if (options.about_center_of_mass || options.origin) return clouds_about_center(clouds, options);
  Result<Part> part = hulls_of(clouds, options);
  if (part) complete(*part, options.threads);
  return part;
}

Result<Part> part_from_convex_groups(const ImportedMesh& mesh, const PartOptions& options) {
  if (Result<void> sound = check_options(options); !sound) return sound.error();
  const Result<std::vector<std::vector<Vec3>>> clouds = clouds_of_groups(mesh, options);
  if (!clouds) return clouds.error();
  PartOptions scaled = options;
  scaled.scale = 1.0;
  return part_from_clouds(*clouds, scaled);
}

Result<Vec3> center_of_convex_groups(const ImportedMesh& mesh, const PartOptions& options) {
  if (Result<void> sound = check_options(options); !sound) return sound.error();
  const Result<std::vector<std::vector<Vec3>>> clouds = clouds_of_groups(mesh, options);
  if (!clouds) return clouds.error();
  PartOptions scaled = options;
  scaled.scale = 1.0;
  const Result<Part> part = hulls_of(*clouds, scaled);
  if (!part) return part.error();
  return part->mass.center;
}

Result<Part> part_from_mesh(const TriangleMesh& mesh, const PartOptions& options) {
  if (Result<void> sound = check_options(options); !sound) return sound.error();
  TriangleMesh scaled = with_used_vertices(mesh);
  for (Vec3& vertex : scaled.vertices) vertex *= options.scale;
  Part part;
  FitMesh fit = fit_for_part(scaled, options.threads, part.notes);
  return finished(std::move(part), std::move(fit), options);
}

Result<Part> part_from_repaired(RepairedMesh repaired, const MeshReport& report, const PartOptions& options) {
  if (Result<void> sound = check_options(options); !sound) return sound.error();
  for (Vec3& vertex : repaired.mesh.vertices) vertex *= options.scale;
  return finished(Part{}, fit_after_repair(std::move(repaired), report), options);
}

}  // namespace tactum::inline v0_1
