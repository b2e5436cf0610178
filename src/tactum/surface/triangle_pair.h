#pragma once
/// Two triangles: their distance, its points, and whether they cross. Any triangle is legal, also one flat to
/// a segment or a point.
///
/// Triangles that do not cross are nearest at a corner of one over the inside of the other, or between two
/// sides: the distance is the least of 6 corner-inside and 9 side-side cases, each solved in closed form.
/// They cross when a side of one passes through the other, as the signs of five volumes show. The volumes are
/// antisymmetric bit for bit in the ends of a triangle's sides, so no line slips between two triangles that
/// share a side. Touching counts as crossing.

#include <array>

#include "tactum/math/types.h"

namespace tactum::inline v0_1 {

using TrianglePoints = std::array<Vec3, 3>;  ///< corners, in one frame [m]

struct PointPair {
  double distance_sq = 1e300;  ///< [m^2]
  Vec3 p_a = Vec3::Zero();     ///< on the first [m]
  Vec3 p_b = Vec3::Zero();     ///< on the second [m]
};

/// Nearest points of the segments a0 a1 and b0 b1; parallel ones and points are fine.
PointPair segment_distance(const Vec3& a0, const Vec3& a1, const Vec3& b0, const Vec3& b1) noexcept;

/// Whether the triangles share a point, from signs alone. Overlaps within one plane are not seen here (all
/// volumes are zero); there sides meet or a corner lies inside, so triangle_distance gives zero up to
/// rounding.
bool triangles_cross(const TrianglePoints& a, const TrianglePoints& b) noexcept;

/// Nearest points of two triangles that do not cross.
PointPair triangle_distance(const TrianglePoints& a, const TrianglePoints& b) noexcept;

}  // namespace tactum::inline v0_1
