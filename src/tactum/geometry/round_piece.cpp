#include "tactum/geometry/round_piece.h"

#include <algorithm>
#include <cmath>

#include "tactum/base/tolerances.h"

namespace tactum::inline v0_1 {
namespace {

/// The point that is equally far from all corners, by least squares; `across` leaves out a direction, along
/// which the point is that of the mean: |p|^2 = 2 c . p + constant.
Vec3 middle_of(const Polytope& piece, const Vec3& across) {
  const Vec3& mean = piece.extent.center;
  Mat3 squares = across * across.transpose() * piece.extent.radius * piece.extent.radius;
  Vec3 right = Vec3::Zero();
  double mean_square = 0.0;
  const auto from_mean = [&](const Vec3& vertex) {
    const Vec3 p = vertex - mean;
    return Vec3(p - across * across.dot(p));
  };
  for (const Vec3& vertex : piece.vertices) mean_square += from_mean(vertex).squaredNorm();
  mean_square /= static_cast<double>(piece.vertices.size());
  for (const Vec3& vertex : piece.vertices) {
    const Vec3 p = from_mean(vertex);
    squares += p * p.transpose();
    right += 0.5 * (p.squaredNorm() - mean_square) * p;
  }
  const double determinant = squares.determinant();
  const double size_sq = piece.extent.size * piece.extent.size;
  if (!(determinant > tolerances::kCoplanar * size_sq * size_sq * size_sq)) return mean;
  return mean + squares.inverse() * right;
}

bool meet_smoothly(const Polytope& piece, const Polytope::Edge& edge, double cosine) {
  return piece.faces[edge.left].normal.dot(piece.faces[edge.right].normal) > cosine;
}

/// The largest distance from a point, less the smallest, of the corners; without what is along `across`.
struct Radii {
  double least, most;
};
Radii spread_of(const Polytope& piece, const Vec3& from, const Vec3& across) {
  Radii spread{1e300, 0.0};
  for (const Vec3& vertex : piece.vertices) {
    const Vec3 p = vertex - from;
    const double distance = (p - across * across.dot(p)).norm();
    spread.least = std::min(spread.least, distance);
    spread.most = std::max(spread.most, distance);
  }
  return spread;
}

double noise_of(const Polytope& piece) { return tolerances::kCoplanarMeshOffset * piece.extent.size; }

RoundPiece sphere_of(const Polytope& piece, double cosine) {
  for (const Polytope::Edge& edge : piece.edges)
    if (!meet_smoothly(piece, edge, cosine)) return {};
  RoundPiece round;
  round.center = middle_of(piece, Vec3::Zero());
  const Radii spread = spread_of(piece, round.center, Vec3::Zero());
  if (spread.most - spread.least > noise_of(piece)) return {};
  round.radius_m = spread.most;
  for (const Polytope::Face& face : piece.faces) {
    const double depth = face.offset - face.normal.dot(round.center);
    if (depth < cosine * round.radius_m) return {};  // a flat end
    round.bulge_m = std::max(round.bulge_m, round.radius_m - depth);
  }
  round.kind = RoundKind::kSphere;
  return round;
}

RoundPiece cylinder_of(const Polytope& piece, double cosine) {
  const auto by_corners = [](const Polytope::Face& a, const Polytope::Face& b) { return a.count < b.count; };
  const auto end = std::max_element(piece.faces.begin(), piece.faces.end(), by_corners);
  const int sides = end->count;
  if (piece.counts[0] != 2 * sides || piece.counts[2] != sides + 2) return {};
  RoundPiece round;
  round.axis = end->normal;
  round.center = middle_of(piece, round.axis);
  round.half_length_m = end->offset - round.axis.dot(round.center);
  const double noise = noise_of(piece);
  const auto is_end = [&](int face) {
    return std::abs(round.axis.dot(piece.faces[face].normal)) > 1.0 - tolerances::kCoplanar;
  };
  for (const Vec3& vertex : piece.vertices)
    if (std::abs(std::abs(round.axis.dot(vertex - round.center)) - round.half_length_m) > noise) return {};
  const Radii spread = spread_of(piece, round.center, round.axis);
  if (spread.most - spread.least > noise) return {};
  round.radius_m = spread.most;
  for (const Polytope::Edge& edge : piece.edges)
    if (!is_end(edge.left) && !is_end(edge.right) && !meet_smoothly(piece, edge, cosine)) return {};
  for (int i = 0; i < piece.counts[2]; ++i) {
    if (is_end(i)) continue;
    const Polytope::Face& face = piece.faces[i];
    round.bulge_m = std::max(round.bulge_m, round.radius_m - (face.offset - face.normal.dot(round.center)));
  }
  round.kind = RoundKind::kCylinder;
  return round;
}

}  // namespace

RoundPiece find_round_piece(const Polytope& piece, double crease_rad) {
  if (piece.flat) return {};
  const double cosine = std::cos(crease_rad);
  const RoundPiece sphere = sphere_of(piece, cosine);
  return sphere.kind != RoundKind::kNone ? sphere : cylinder_of(piece, cosine);
}

}  // namespace tactum::inline v0_1
