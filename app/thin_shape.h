#pragma once
/// Points and segments as shapes of `tactum distance`. The contact core walks on closed polyhedra, which they
/// are not; beside it, all their features are tried, which is exact.

#include <optional>
#include <vector>

#include "tactum/collision/contact.h"
#include "tactum/geometry/polytope.h"

namespace tactum {

/// A point when both ends are equal.
struct ThinShape {
  Vec3 tail = Vec3::Zero(), head = Vec3::Zero();  ///< [m]
};

/// The hull of points that lie on one line or in one place, to rounding; nothing when they span more.
std::optional<ThinShape> thin_hull(const std::vector<Vec3>& points);

/// Signed distance, witness points and normal as of contact.h, with A the thin shape; both in one frame. An
/// overlap is searched over every facet of the Minkowski difference. Cost: features of B.
PairDistance thin_distance(const ThinShape& A, const Polytope& B);
PairDistance thin_distance(const ThinShape& A, const ThinShape& B);

}  // namespace tactum
