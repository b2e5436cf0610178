#pragma once
/// Input and output of the readers of mesh files: limits, the mesh with its groups, and a report of the
/// differences from the file.

#include <cstddef>
#include <string>
#include <vector>

#include "tactum/geometry/triangle_mesh.h"

namespace tactum::inline v0_1 {

struct ImportOptions {
  double scale = 1.0;                  ///< metres per unit of the file [m]
  std::size_t max_bytes = 1ull << 30;  ///< larger files are refused [bytes]
  int max_vertices = 20'000'000;       ///< more are refused
  int max_triangles = 20'000'000;      ///< more are refused
  double max_coordinate = 1e9;         ///< larger coordinates are refused as nonsense [units of the file]
};

/// The triangles of one object of the file: [first_triangle, first_triangle + triangle_count).
struct MeshGroup {
  std::string name;
  int first_triangle = 0;
  int triangle_count = 0;
};

/// The differences between the mesh and the file.
struct ImportReport {
  std::string format;                ///< "OBJ", "STL (binary)", ...
  bool in_metres = false;            ///< by the standard of the format, or by the unit that the file says
  int polygons_split = 0;            ///< faces of more than three corners, cut into triangles
  int concave_polygons = 0;          ///< ... of which not convex
  int points_dropped = 0;            ///< point elements
  int lines_dropped = 0;             ///< line elements
  int faces_dropped = 0;             ///< faces of fewer than three corners
  int unused_vertices = 0;           ///< vertices no triangle uses (kept, but of glTF)
  std::vector<std::string> remarks;  ///< the same and more as sentences
};

struct ImportedMesh {
  TriangleMesh mesh;
  std::vector<MeshGroup> groups;  ///< at least one, in order, covering all triangles
  ImportReport report;
};

}  // namespace tactum::inline v0_1
