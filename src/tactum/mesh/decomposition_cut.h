#pragma once
/// A solid cut in two by a plane.
///
///        ______                Corners within the noise of the plane are on it, once and for all faces. An
///       |      |               edge that crosses gets one new corner, shared by all faces at the edge. Each
///   - - x - - -x- - -          face is then cut along a line: between neighbouring corners on the line the
///       |    __|               face has interior above it or not, and below it or not, which is found by
///       |___|                  counting the sides that arrive from there. No coordinate decides anything
///                              but the order on the line. The cap is what is left open: the same sides for
///                              both halves, turned round.

#include "tactum/mesh/decomposition_solid.h"

namespace tactum::inline v0_1::detail {

struct CutPlane {
  Vec3 normal = Vec3::Zero();  ///< unit
  double offset = 0.0;         ///< [m]
};

struct Halves {
  Solid below, above;  ///< either may be empty
};

/// New corners are appended to `corners`. An error gives the place where counting failed: the surface crosses
/// itself there, or is thinner than the noise. O(sides log sides).
Result<Halves> cut(std::vector<Vec3>& corners, const Solid& solid, const CutPlane& plane, double noise);

}  // namespace tactum::inline v0_1::detail
