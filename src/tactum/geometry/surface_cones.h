#pragma once
/// The features of a triangle surface that have a normal cone, the triangles that own them, and the widths of
/// their cones: the topology under surface_tree.h.

#include <array>
#include <cstdint>
#include <vector>

#include "tactum/geometry/triangle_mesh.h"

namespace tactum::inline v0_1 {

/// A feature that can be nearest to something, with the cone around its normal cone.
struct ConedFeature {
  std::int32_t corner = -1;  ///< as in the leaves of a SurfaceTree
  Vec3 axis;                 ///< unit [-]
  double width = 0.0;        ///< largest angle from the axis to a direction of the cone [rad]
};

struct SurfaceCones {
  std::array<std::vector<ConedFeature>, 3> features;  ///< by SurfaceLayout::Kind
  std::vector<Vec3> normal;                           ///< of each triangle, unit, outward [-]
  std::vector<std::array<std::int32_t, 3>> beyond;    ///< SurfaceTree::beyond
  std::vector<std::uint8_t> narrow;                   ///< SurfaceTree::narrow_edge, narrow_vertex
  std::vector<std::int32_t> first_around, around;     ///< SurfaceTree::around
};

SurfaceCones surface_cones(const TriangleMesh& mesh, const std::vector<int>& group);

/// The directions u with e . u <= 0 for all `edges`: rays whose hull they are; none when the cone has no
/// inside.
std::vector<Vec3> polar_cone(const std::vector<Vec3>& edges);

}  // namespace tactum::inline v0_1
