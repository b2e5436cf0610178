#include "tactum/mesh/prepare_pieces.h"

#include <fmt/format.h>

#include <utility>

#include "tactum/mesh/decomposition.h"
#include "tactum/mesh/make_part.h"
#include "tactum/repair/mesh_repair.h"

namespace tactum::inline v0_1 {
namespace {

std::string groups_suit(const PiecesInput& input) {
  if (input.given.groups.size() < 2) return {};
  return fmt::format("the mesh comes in {} groups, each closed and convex", input.given.groups.size());
}

/// The groups, each repaired by itself and so facing outward, moved by -origin.
ImportedMesh groups_outward(const ImportedMesh& given, const Vec3& origin) {
  ImportedMesh out;
  for (const MeshGroup& group : given.groups) {
    const auto first = given.mesh.triangles.begin() + group.first_triangle;
    TriangleMesh own;
    for (auto t = first; t != first + group.triangle_count; ++t) {
      const int corner = static_cast<int>(own.vertices.size());
      for (int vertex : *t) own.vertices.emplace_back(given.mesh.vertices[vertex] - origin);
      own.triangles.push_back({corner, corner + 1, corner + 2});
    }
    own = repair_mesh(own).mesh;
    const int base = static_cast<int>(out.mesh.vertices.size());
    out.groups.push_back(
        {group.name, static_cast<int>(out.mesh.triangles.size()), static_cast<int>(own.triangles.size())});
    out.mesh.vertices.insert(out.mesh.vertices.end(), own.vertices.begin(), own.vertices.end());
    for (const Triangle& t : own.triangles)
      out.mesh.triangles.push_back({base + t[0], base + t[1], base + t[2]});
  }
  return out;
}

Result<Part> part_from_groups(const PiecesInput& input, const Vec3& origin) {
  return part_from_convex_groups(groups_outward(input.given, origin), input.options);
}

Result<Vec3> center_of_groups(const PiecesInput& input) {
  return center_of_convex_groups(groups_outward(input.given, Vec3::Zero()), input.options);
}

/// The pieces of the groups, each by itself: where two share a wall, the whole is no closed surface.
double volume_of_groups(const PiecesInput& input) {
  const TriangleMesh mesh = groups_outward(input.given, bounds(input.repaired.mesh.vertices).center()).mesh;
  double six_volumes = 0.0;
  for (const Triangle& t : mesh.triangles)
    six_volumes += mesh.vertices[t[0]].dot(mesh.vertices[t[1]].cross(mesh.vertices[t[2]]));
  return six_volumes / 6.0;
}

double volume_of_mesh(const PiecesInput& input) {
  return input.report.closed && input.report.oriented ? input.report.volume : -1.0;
}

/// As part_from_mesh chooses: solid where that takes few pieces. Nothing else of the part is made for this
/// decision; making the cuts twice costs little where they are few, and where they are not the search ends
/// early.
std::string solid_suits(const PiecesInput& input) {
  if (!input.report.closed || !input.report.oriented) return {};
  if (input.report.convex) return "the mesh is convex as it is";
  const Result<SolidPieces> solid = solid_pieces(input.repaired.mesh, kFewSolidPieces);
  if (!solid) return {};
  return fmt::format("the solid falls into {} convex pieces along {} reflex edge{}", solid->pieces.size(),
                     solid->reflex_edges, solid->reflex_edges == 1 ? "" : "s");
}

std::string surface_suits(const PiecesInput& input) {
  if (input.report.closed)
    return "the solid does not fall into few convex pieces: it is felt by its surface as it is";
  return input.report.balanced
             ? "solids of the mesh touch along edges: it is felt by its surface as it is"
             : "the mesh is not closed: it is felt by its surface as it is, from both sides";
}

Result<Vec3> center_of_mesh(const PiecesInput& input) {
  return mass_properties_or_hull(input.repaired.mesh, input.options.density_kg_per_m3).center;
}

Result<Part> part_by(PieceSource pieces, const PiecesInput& input, const Vec3& origin) {
  RepairedMesh moved = input.repaired;
  for (Vec3& vertex : moved.mesh.vertices) vertex -= origin;
  PartOptions options = input.options;
  options.pieces = pieces;
  return part_from_repaired(std::move(moved), input.report, options);
}

Result<Part> part_from_solid(const PiecesInput& input, const Vec3& origin) {
  return part_by(PieceSource::kSolid, input, origin);
}

Result<Part> part_from_surface(const PiecesInput& input, const Vec3& origin) {
  return part_by(PieceSource::kSurface, input, origin);
}

}  // namespace

const std::vector<PieceMethod>& all_piece_methods() {
  static const std::vector<PieceMethod> methods = {
      {"given", groups_suit, center_of_groups, volume_of_groups, part_from_groups},
      {"solid", solid_suits, center_of_mesh, volume_of_mesh, part_from_solid},
      {"surface", surface_suits, center_of_mesh, volume_of_mesh, part_from_surface}};
  return methods;
}

}  // namespace tactum::inline v0_1
