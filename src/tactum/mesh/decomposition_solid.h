#pragma once
/// A solid while it is being cut: flat faces, each a set of directed sides, and nothing else. A face may have
/// holes and several outlines; its interior lies left of every side, seen from outside. Corners are numbers
/// into one list that all solids of a decomposition share, so two halves of a cut have the very same corners.
///
///        <-----------.          A side that runs (u, v) in one face runs (v, u) in its neighbour. The wedge
///       |   .---->   |          of an edge is the angle through the solid from face to face: below pi the
///       |   |  hole| |          edge is convex, above it is reflex, and the solid must be cut there.
///       |   <----.   |
///       '----------->
///
/// Edges where more than two faces meet (bodies that touch along an edge) are paired through the solid, so
/// that bodies that only touch come apart.

#include <array>
#include <vector>

#include "tactum/base/result.h"
#include "tactum/geometry/triangle_mesh.h"

namespace tactum::inline v0_1::detail {

/// From corner to corner.
using SolidSide = std::array<int, 2>;

struct SolidFace {
  Vec3 normal = Vec3::Zero();  ///< unit, outward
  double offset = 0.0;         ///< normal . x [m]
  double error_bound = 0.0;    ///< how far the normal may be off: large for slivers of the input [rad]
  std::vector<SolidSide> sides;
};

using Solid = std::vector<SolidFace>;

/// The left face runs tail -> head, the right one head -> tail.
struct SolidEdge {
  int tail = 0, head = 0;
  int left = 0, right = 0;
  double wedge = 0.0;   ///< angle through the solid, 0 .. 2 pi [rad]
  bool reflex = false;  ///< above pi by more than both faces' error bounds
};

/// The solid of a closed, oriented, manifold mesh; coplanar triangles make one face. `noise` [m]: heights
/// below it are none. An error names what is open or folded, and where.
Result<Solid> solid_of_mesh(const TriangleMesh& mesh, double noise);

/// All edges, sorted by their corners. An error names a side without a partner.
Result<std::vector<SolidEdge>> edges_of(const std::vector<Vec3>& corners, const Solid& solid);

/// The connected bodies of a solid, with faces of one outline (and its holes) each.
Result<std::vector<Solid>> bodies_of(const std::vector<Vec3>& corners, const Solid& solid);

/// By the divergence theorem [m^3].
double volume_of(const std::vector<Vec3>& corners, const Solid& solid);
/// [m^2]
double area_of(const std::vector<Vec3>& corners, const Solid& solid);

/// The corners it has, each once, in order of their numbers.
std::vector<int> corners_of(const Solid& solid);

/// "(x y z)", for sentences.
std::string place(const Vec3& p);

}  // namespace tactum::inline v0_1::detail
