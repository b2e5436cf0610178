#include "tactum/collision/seams.h"

#include <algorithm>

#include "tactum/base/tolerances.h"

namespace tactum {
namespace {

using Index = std::size_t;

double noise_of(const Part& part) noexcept { return tolerances::kCoplanarMeshOffset * part.size; }

int number_of(const Part& part, int piece, const Feature& feature) noexcept {
  return part.true_surface.number(piece, static_cast<int>(feature.kind), feature.index);
}

bool in_column(const Polytope& P, int face, const Vec3& p, double slack) noexcept {
  const Polytope::Face& loop = P.faces[face];
  for (int slot = loop.first; slot < loop.first + loop.count; ++slot)
    if (P.sides[slot].normal.dot(p) > P.sides[slot].offset + slack) return false;
  return true;
}

/// Of one side: the faces of `F`, told in its own frame, against the support of `S`. Calls
/// take(face, vertex of S, distance) for those that could be nearer than `best`.
template <class Take>
void for_true_faces(const Part& part, int piece, const Polytope& S, const Pose& X_FS, int start,
                    const Take& take) noexcept {
  const Polytope& F = part.pieces[Index(piece)];
  int vertex = start;
  for (int face = 0; face < F.counts[2]; ++face) {
    const bool covered =
        !part.true_surface.alone() &&
        part.true_surface.group[Index(number_of(part, piece, {FeatureKind::kFace, face}))] < 0;
    if (covered) continue;
    const Vec3& normal = F.faces[face].normal;
    vertex = support_vertex(S, -rotated_back(X_FS.R, normal), vertex);
    take(face, vertex, normal.dot(X_FS * S.vertices[vertex]) - F.faces[face].offset);
  }
}

}  // namespace

bool allowed_by_neighbours(const Part& part, int piece, const Feature& feature, const Vec3& p,
                           const Vec3& outward) noexcept {
  if (part.true_surface.alone()) return true;
  const double noise = noise_of(part);
  const double height = outward.dot(p);
  const auto neighbours = part.true_surface.neighbours(number_of(part, piece, feature));
  return std::none_of(neighbours.begin(), neighbours.end(), [&](int neighbour) {
    const Polytope& N = part.pieces[Index(neighbour)];
    if (outward.dot(N.vertices[support_vertex(N, outward)]) <= height + 2.0 * noise) return false;
    return std::all_of(N.faces.begin(), N.faces.end(), [&](const Polytope::Face& plane) {
      return plane.normal.dot(p) <= plane.offset + 2.0 * noise;
    });
  });
}

bool is_true_contact(const Part& part_a, int piece_a, const Part& part_b, int piece_b, const Pose& X_AB,
                     const PairDistance& found) noexcept {
  return allowed_by_neighbours(part_a, piece_a, found.a, found.p_a, -found.normal) &&
         (part_b.true_surface.alone() ||
          allowed_by_neighbours(part_b, piece_b, found.b, rotated_back(X_AB.R, found.p_b - X_AB.p),
                                rotated_back(X_AB.R, found.normal)));
}

Feature same_feature(const Part& part, int of_piece, const Feature& feature, int piece) noexcept {
  if (piece == of_piece) return feature;
  if (part.true_surface.alone() || feature.kind == FeatureKind::kVertex) return {feature.kind, -1};
  const int group = part.true_surface.group[Index(number_of(part, of_piece, feature))];
  if (group < 0) return {feature.kind, -1};
  const int first = number_of(part, piece, {feature.kind, 0});
  const int count = part.pieces[Index(piece)].counts[Index(feature.kind)];
  for (int i = 0; i < count; ++i)
    if (part.true_surface.group[Index(first + i)] == group) return {feature.kind, i};
  return {feature.kind, -1};
}

std::optional<PairDistance> depth_under_true_faces(const Part& part_a, int piece_a, const Part& part_b,
                                                   int piece_b, const Pose& X_AB, const PairDistance& found,
                                                   double slack) noexcept {
  const Polytope& A = part_a.pieces[Index(piece_a)];
  const Polytope& B = part_b.pieces[Index(piece_b)];
  const Pose X_BA = X_AB.inverse();
  std::optional<PairDistance> best;
  const auto take = [&](const PairDistance& candidate) {
    if (is_true_contact(part_a, piece_a, part_b, piece_b, X_AB, candidate)) best = candidate;
  };
  const auto nearer = [&](double distance) { return !best || distance > best->distance; };
  for_true_faces(part_b, piece_b, A, X_BA, vertex_of(A, found.a), [&](int face, int vertex, double distance) {
    const Vec3& normal = B.faces[face].normal;
    const Vec3 foot = X_BA * A.vertices[vertex] - normal * distance;
    if (!nearer(distance) || !in_column(B, face, foot, slack)) return;
    take({.distance = distance,
          .p_a = A.vertices[vertex],
          .p_b = X_AB * foot,
          .normal = X_AB.R * normal,
          .a = {FeatureKind::kVertex, vertex},
          .b = {FeatureKind::kFace, face},
          .stop = Stop::kFallback});
  });
  for_true_faces(part_a, piece_a, B, X_AB, vertex_of(B, found.b), [&](int face, int vertex, double distance) {
    const Vec3& normal = A.faces[face].normal;
    const Vec3 deepest = X_AB * B.vertices[vertex];
    const Vec3 foot = deepest - normal * distance;
    if (!nearer(distance) || !in_column(A, face, foot, slack)) return;
    take({.distance = distance,
          .p_a = foot,
          .p_b = deepest,
          .normal = -normal,
          .a = {FeatureKind::kFace, face},
          .b = {FeatureKind::kVertex, vertex},
          .stop = Stop::kFallback});
  });
  return best;
}

bool answered_by(const PairView& pair, const PairDistance& found, const Vec3& n, double distance) noexcept {
  int a = vertex_of(pair.A, found.a);
  int b = vertex_of(pair.B, found.b);
  return pair.separation(n, a, b) >= distance - tolerances::kCoplanarMeshOffset * pair.size;
}

}  // namespace tactum
