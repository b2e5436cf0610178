#include "bench/overlap.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tactum/base/tolerances.h"

namespace tactum::bench {
namespace {

void add_direction(const Vec3& d, std::vector<Vec3>& all) {
  const bool known = std::any_of(all.begin(), all.end(), [&](const Vec3& other) {
    return d.cross(other).norm() < tolerances::kParallelSine;
  });
  if (!known) all.push_back(d);
}

struct Extent {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  Extent(const std::vector<Vec3>& corners, const Vec3& axis) {
    for (const Vec3& p : corners) {
      const double at = axis.dot(p);
      low = std::min(low, at);
      high = std::max(high, at);
    }
  }
};

}  // namespace

OverlapPiece overlap_piece(const Polytope& P, const Pose& X) {
  OverlapPiece piece;
  for (const Vec3& v : P.vertices) piece.corners.push_back(X * v);
  for (const auto& face : P.faces) add_direction(X.R * face.normal, piece.normals);
  for (const auto& edge : P.edges) add_direction(X.R * edge.direction, piece.directions);
  return piece;
}

double overlap(const OverlapPiece& a, const OverlapPiece& b) {
  double least = std::numeric_limits<double>::infinity();
  const auto look = [&](const Vec3& axis) {
    const Extent of_a(a.corners, axis), of_b(b.corners, axis);
    least = std::min(least, std::min(of_a.high - of_b.low, of_b.high - of_a.low));
  };
  for (const Vec3& n : a.normals) look(n);
  for (const Vec3& n : b.normals) look(n);
  for (const Vec3& d : a.directions)
    for (const Vec3& e : b.directions) {
      if (least <= 0.0) return 0.0;
      const Vec3 axis = d.cross(e);
      const double length = axis.norm();
      if (length > tolerances::kParallelSine) look(axis / length);
    }
  return std::max(0.0, least);
}

OverlapPiece carried(const OverlapPiece& piece, const Pose& X) {
  OverlapPiece moved = piece;
  for (Vec3& v : moved.corners) v = X * v;
  for (Vec3& n : moved.normals) n = X.R * n;
  for (Vec3& d : moved.directions) d = X.R * d;
  return moved;
}

}  // namespace tactum::bench
