#pragma once
/// A solid cut in two by a plane.
///
///        ______                Corners within the noise of the plane are on it, once and for all faces; an
///        edge
///       |      |               that crosses gets one new corner, shared by all that have the edge. Each face
///       is
///   - - x - - -x- - -          then cut along a line: between neighbouring corners on the line the face has
///       |    __|               interior above it or not, and below it or not, told by counting the sides
///       that
///       |___|                  arrive from there. No coordinate decides anything but the order on the line.
///                              The cap is what is left open: the same sides for both halves, turned round.

#include "tactum/mesh/decomposition_solid.h"

namespace tactum::detail {

struct CutPlane {
  Vec3 normal = Vec3::Zero();  ///< unit
  double offset = 0.0;         ///< [m]
};

struct Halves {
  Solid below, above;  ///< either may be empty
};

/// New corners are appended to `corners`. An error says where counting went wrong: the surface crosses itself
/// there, or is thinner than the noise. O(sides log sides).
Result<Halves> cut(std::vector<Vec3>& corners, const Solid& solid, const CutPlane& plane, double noise);

}  // namespace tactum::detail
