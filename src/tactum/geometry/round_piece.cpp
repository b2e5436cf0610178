#include "tactum/geometry/round_piece.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "tactum/base/tolerances.h"

namespace tactum::inline v0_1 {
namespace {

/// Corners about a point in their middle.
struct Corners {
  std::span<const Vec3> vertices;
  Vec3 middle;
  double radius, size;  // greatest distance from the middle, about, and of two corners [m]
};

Corners corners_of(const Polytope& piece) {
  return {{piece.vertices.data(), piece.vertices.size()},
          piece.extent.center,
          piece.extent.radius,
          piece.extent.size};
}

/// The point that is equally far from all corners, by least squares; `across` leaves out a direction, along
/// which the point is that of the middle: |p|^2 = 2 c . p + constant.
Vec3 center_of(const Corners& corners, const Vec3& across) {
  Mat3 squares = across * across.transpose() * corners.radius * corners.radius;
  Vec3 right = Vec3::Zero();
  double mean_square = 0.0;
  const auto from_middle = [&](const Vec3& vertex) {
    const Vec3 p = vertex - corners.middle;
    return Vec3(p - across * across.dot(p));
  };
  for (const Vec3& vertex : corners.vertices) mean_square += from_middle(vertex).squaredNorm();
  mean_square /= static_cast<double>(corners.vertices.size());
  for (const Vec3& vertex : corners.vertices) {
    const Vec3 p = from_middle(vertex);
    squares += p * p.transpose();
    right += 0.5 * (p.squaredNorm() - mean_square) * p;
  }
  const double determinant = squares.determinant();
  const double size_sq = corners.size * corners.size;
  if (!(determinant > tolerances::kCoplanar * size_sq * size_sq * size_sq)) return corners.middle;
  return corners.middle + squares.inverse() * right;
}

bool meet_smoothly(const Polytope& piece, const Polytope::Edge& edge, double cosine) {
  return piece.faces[edge.left].normal.dot(piece.faces[edge.right].normal) > cosine;
}

/// The smallest and the largest distance of the corners from a point; without what is along `across`.
struct Radii {
  double least, most;
};
Radii spread_of(const Corners& corners, const Vec3& from, const Vec3& across) {
  Radii spread{1e300, 0.0};
  for (const Vec3& vertex : corners.vertices) {
    const Vec3 p = vertex - from;
    const double distance = (p - across * across.dot(p)).norm();
    spread.least = std::min(spread.least, distance);
    spread.most = std::max(spread.most, distance);
  }
  return spread;
}

double noise_of(double size_m) { return tolerances::kCoplanarMeshOffset * size_m; }

RoundPiece sphere_of(const Polytope& piece, double cosine) {
  for (const Polytope::Edge& edge : piece.edges)
    if (!meet_smoothly(piece, edge, cosine)) return {};
  RoundPiece round;
  round.center = center_of(corners_of(piece), Vec3::Zero());
  const Radii spread = spread_of(corners_of(piece), round.center, Vec3::Zero());
  if (spread.most - spread.least > noise_of(piece.extent.size)) return {};
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
  round.center = center_of(corners_of(piece), round.axis);
  round.half_length_m = end->offset - round.axis.dot(round.center);
  const double noise = noise_of(piece.extent.size);
  const auto is_end = [&](int face) {
    return std::abs(round.axis.dot(piece.faces[face].normal)) > 1.0 - tolerances::kCoplanar;
  };
  for (const Vec3& vertex : piece.vertices)
    if (std::abs(std::abs(round.axis.dot(vertex - round.center)) - round.half_length_m) > noise) return {};
  const Radii spread = spread_of(corners_of(piece), round.center, round.axis);
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

RoundPiece find_ball(const TriangleMesh& mesh, double crease_rad) {
  const bool one_skin = mesh.triangles.size() + 4 == 2 * mesh.vertices.size();  // closed and without a hole
  if (mesh.vertices.empty() || !one_skin) return {};
  Aabb box;
  Vec3 mean = Vec3::Zero();
  for (const Vec3& vertex : mesh.vertices) {
    box.extend(vertex);
    mean += vertex / static_cast<double>(mesh.vertices.size());
  }
  const Corners corners{mesh.vertices, mean, box.half().norm(), box.diagonal()};
  RoundPiece round;
  round.center = center_of(corners, Vec3::Zero());
  const Radii spread = spread_of(corners, round.center, Vec3::Zero());
  if (spread.most - spread.least > noise_of(corners.size)) return {};
  round.radius_m = spread.most;
  for (const Triangle& t : mesh.triangles) {
    const Vec3& p = mesh.vertices[std::size_t(t[0])];
    const Vec3 normal =
        (mesh.vertices[std::size_t(t[1])] - p).cross(mesh.vertices[std::size_t(t[2])] - p).normalized();
    const double depth_m = normal.dot(p - round.center);
    if (!(depth_m >= std::cos(crease_rad) * round.radius_m)) return {};
    round.bulge_m = std::max(round.bulge_m, round.radius_m - depth_m);
  }
  round.kind = RoundKind::kSphere;
  return round;
}

RoundPiece find_round_piece(const Polytope& piece, double crease_rad) {
  if (piece.flat) return {};
  const double cosine = std::cos(crease_rad);
  const RoundPiece sphere = sphere_of(piece, cosine);
  return sphere.kind != RoundKind::kNone ? sphere : cylinder_of(piece, cosine);
}

}  // namespace tactum::inline v0_1
