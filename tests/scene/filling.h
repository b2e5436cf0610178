#pragma once
/// Judges convex pieces by points: which pieces contain a point, and their mass together.

#include <vector>

#include "tactum/geometry/part.h"
#include "tactum/mesh/make_part.h"

namespace tactum::filling {

inline int pieces_holding(const std::vector<Polytope>& pieces, const Vec3& p) {
  int count = 0;
  for (const Polytope& piece : pieces) {
    bool inside = true;
    for (const auto& face : piece.faces) inside = inside && face.normal.dot(p) < face.offset;
    count += inside ? 1 : 0;
  }
  return count;
}

/// Volume of all pieces together [m^3].
inline double volume(const std::vector<Polytope>& pieces) {
  std::vector<std::vector<Vec3>> clouds;
  for (const Polytope& piece : pieces) clouds.push_back(piece.vertices);
  return part_from_clouds(clouds)->mass.volume;
}

}  // namespace tactum::filling
