#pragma once
/// Triangles of a polygon face. A convex polygon becomes a fan from its first corner, as most programs cut
/// it; a concave one is cut by clipping ears in its mean plane, where a fan would lay triangles outside the
/// face. O(n) for convex, O(n^2) mostly and O(n^3) at worst for concave polygons.

#include <vector>

#include "tactum/geometry/triangle_mesh.h"

namespace tactum::inline v0_1::detail {

/// Largest concave polygon that is cut; the bound keeps a hostile file from taking minutes.
inline constexpr int kMaxConcaveCorners = 2048;

enum class SplitKind { kConvex, kConcave, kFailed };

/// Appends the triangles of the polygon with these corners (indices into `vertices`, at least three) to
/// `triangles`. kFailed: a concave polygon with too many corners, nothing appended.
SplitKind split_polygon(const std::vector<Vec3>& vertices, const std::vector<int>& corners,
                        std::vector<Triangle>& triangles);

}  // namespace tactum::inline v0_1::detail
