#include "tactum/embedding/part_query.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <utility>

#include "tactum/base/tolerances.h"
#include "tactum/collision/closest_features.h"
#include "tactum/collision/penetration.h"
#include "tactum/math/rotation.h"
#include "tactum/mesh/mesh_import.h"

namespace tactum::inline v0_1 {
namespace {

/// Edge pairs up to which overlapping pieces are searched in full; at 10 ns each, the most costs 40 s.
constexpr double kMostEdgePairsOfQuery = 4e9;

std::shared_ptr<const QueriedPart> queried(PartFile file) {
  return std::make_shared<const QueriedPart>(std::move(file));
}

/// Global where the pieces overlap and are small enough to be searched.
PairDistance distance_of_pieces(const Polytope& A, const Polytope& B, const Pose& X_AB) {
  PairCache cache{};
  const PairDistance found = closest_features(A, B, X_AB, cache);
  const double pairs = static_cast<double>(A.edges.size()) * static_cast<double>(B.edges.size());
  if (found.distance >= 0.0 || pairs > kMostEdgePairsOfQuery) return found;
  return penetration_exhaustive(A, B, X_AB);
}

Result<void> check_solid(const QueriedPart& part) {
  if (!part.file().part.is_surface() && !part.file().part.pieces.front().flat) return {};
  return Error{"a signed distance is one of solid pieces", "a part that is felt by its surface",
               "a part of solid pieces, or its clearance", part.file().part.name};
}

/// The body's frame, at the centre of mass, of a part whose frame P is at X_WP.
Pose body_pose(const QueriedPart& part, const Pose& X_WP) { return {X_WP.R, X_WP * part.file().origin}; }

}  // namespace

Result<std::shared_ptr<const QueriedPart>> QueriedPart::load(const std::string& path,
                                                             const PrepareOptions& options) {
  if (is_part_file(path)) {
    Result<PartFile> file = load_part(path);
    if (!file) return file.error();
    return queried(std::move(*file));
  }
  Result<ImportedMesh> mesh = import_mesh(path);
  if (!mesh) return mesh.error();
  PrepareOptions named = options;
  if (named.name.empty()) named.name = std::filesystem::path(path).stem().string();
  Result<PartFile> file = prepare_part(std::move(*mesh), named);
  if (!file) return file.error();
  return queried(std::move(*file));
}

Result<std::shared_ptr<const QueriedPart>> QueriedPart::from_mesh(TriangleMesh mesh,
                                                                  const PrepareOptions& options) {
  PrepareOptions named = options;
  if (named.name.empty()) named.name = "mesh";
  if (mesh.triangles.empty()) return Error{"a mesh has no triangles", "none", "at least one", named.name};
  const auto count = static_cast<int>(mesh.vertices.size());
  for (const Vec3& vertex : mesh.vertices)
    if (!vertex.allFinite()) return Error{"a vertex is not finite", "", "numbers", named.name};
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (const int corner : mesh.triangles[i])
      if (corner < 0 || corner >= count)
        return Error{fmt::format("triangle {} names a vertex that is not there", i), std::to_string(corner),
                     fmt::format("0 to {}", count - 1), named.name};
  ImportedMesh given;
  given.groups = {{named.name, 0, static_cast<int>(mesh.triangles.size())}};
  given.report.format = "memory";
  given.report.in_metres = named.unit == "auto";
  if (named.unit == "auto" && named.scale <= 0.0) named.unit = "m";
  given.mesh = std::move(mesh);
  Result<PartFile> file = prepare_part(std::move(given), named);
  if (!file) return file.error();
  return queried(std::move(*file));
}

QueriedPart::QueriedPart(PartFile file)
    : file_(std::move(file)), mesh_(surface_in_mesh_frame(file_)), surface_(mesh_), interior_(mesh_) {}

PartDistance clearance(const QueriedPart& a, const Pose& X_WA, const QueriedPart& b, const Pose& X_WB,
                       SurfacePairCache& cache) noexcept {
  const Pose X_AB = relative_pose(X_WA, X_WB);
  const SurfaceDistance found = surface_distance(a.surface(), b.surface(), X_AB, cache);
  PartDistance answer;
  answer.touching_pairs = found.touching_pairs;
  answer.inside = found.touching_pairs == 0 && one_inside_other(a.interior(), b.interior(), X_AB);
  answer.distance = answer.inside ? 0.0 : found.distance;
  answer.p_a_W = X_WA * found.p_a;
  answer.p_b_W = X_WA * found.p_b;
  const Vec3 apart = answer.p_a_W - answer.p_b_W;
  if (answer.distance > 0.0) answer.n_BA_W = apart.normalized();
  return answer;
}

Result<PartDistance> signed_distance(const QueriedPart& a, const Pose& X_WA, const QueriedPart& b,
                                     const Pose& X_WB) {
  for (const QueriedPart* part : {&a, &b})
    if (Result<void> solid = check_solid(*part); !solid) return solid.error();
  const Pose X_WA_body = body_pose(a, X_WA);
  const Pose X_AB = relative_pose(X_WA_body, body_pose(b, X_WB));
  PairDistance nearest;
  bool first = true;
  for (const Polytope& piece_a : a.file().part.pieces)
    for (const Polytope& piece_b : b.file().part.pieces) {
      const PairDistance one = distance_of_pieces(piece_a, piece_b, X_AB);
      if (first || one.distance < nearest.distance) nearest = one;
      first = false;
    }
  PartDistance answer;
  answer.distance = nearest.distance;
  answer.p_a_W = X_WA_body * nearest.p_a;
  answer.p_b_W = X_WA_body * nearest.p_b;
  answer.n_BA_W = X_WA_body.R * nearest.normal;
  answer.certified = nearest.certified();
  return answer;
}

Result<void> check_pose(const Pose& X, const char* name) {
  if (!X.finite()) return Error{"a pose is not finite", "", "numbers", name};
  const NearestRotation nearest = orthonormalized(X.R);
  if (nearest.exists && nearest.deviation <= tolerances::kRotationNear) return {};
  return Error{"the matrix of a pose is no rotation",
               nearest.exists ? fmt::format("|M M^T - I| up to {:.3g}", nearest.deviation)
                              : std::string("a reflection, or a matrix that is singular"),
               fmt::format("at most {:g}, and no reflection", tolerances::kRotationNear), name};
}

}  // namespace tactum::inline v0_1
