#pragma once
/// Welding: vertices in one place become one, and triangles that are none are removed. STL stores each corner
/// anew, OBJ doubles vertices where textures meet; without welding such meshes look full of holes.
///
/// Vertices are taken in order; each joins the first kept vertex within the tolerance (a grid hash finds it)
/// or is kept. Deterministic, O(n). Kept vertices are never moved, so surviving triangles keep the file's
/// coordinates.

#include <vector>

#include "tactum/base/tolerances.h"
#include "tactum/geometry/triangle_mesh.h"

namespace tactum::inline v0_1 {

struct WeldOptions {
  double tolerance = tolerances::kWeld;  ///< fraction of the mesh's diagonal; 0 joins only equal points [-]
  bool drop_zero_area = false;  ///< also drop triangles without area (their corners differ but lie on a line)
  bool drop_duplicates = false;  ///< also drop later triangles with the same three corners
};

struct WeldReport {
  int vertices_joined = 0;  ///< fewer vertices than before
  // Numbers of the triangles, in the mesh given, that were dropped:
  std::vector<int> index_degenerate;  ///< two corners became one (or were)
  std::vector<int> zero_area;         ///< thinner than tolerances::kDegenerateTriangle
  std::vector<int> duplicates;        ///< the same corners as an earlier one
};

struct WeldedMesh {
  TriangleMesh mesh;
  std::vector<int> source;  ///< number in the mesh given of each triangle
  WeldReport report;
};

WeldedMesh weld(const TriangleMesh& mesh, const WeldOptions& options = {});

/// Whether the triangle has no usable normal: height over its longest edge below
/// tolerances::kDegenerateTriangle.
bool has_no_area(const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace tactum::inline v0_1
