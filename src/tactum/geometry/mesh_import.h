#pragma once
/// Meshes from files: OBJ, STL and PLY (text and binary), OFF, glTF and GLB.
///
/// Text and the simple binary formats are read by our own readers: they keep the file's doubles (assimp
/// stores single precision), split concave polygons rightly (a fan would fold over), name the line or byte
/// where a file is wrong, and are bounded: no count from the file is believed before the bytes for it are
/// seen. glTF goes through assimp, but only after its structure was checked and everything that is not
/// geometry taken out (gltf_check.h).
///
/// Vertices and triangles come as the file has them, not welded (see weld.h). No exception leaves these
/// functions.

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "tactum/base/result.h"
#include "tactum/geometry/triangle_mesh.h"

namespace tactum {

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

/// What was not taken as it stood in the file.
struct ImportReport {
  std::string format;                ///< "OBJ", "STL (binary)", ...
  int polygons_split = 0;            ///< faces of more than three corners, cut into triangles
  int concave_polygons = 0;          ///< ... of which not convex
  int points_dropped = 0;            ///< point elements
  int lines_dropped = 0;             ///< line elements
  int faces_dropped = 0;             ///< faces of fewer than three corners
  int unused_vertices = 0;           ///< vertices no triangle uses (kept)
  std::vector<std::string> remarks;  ///< the same and more as sentences
};

struct ImportedMesh {
  TriangleMesh mesh;
  std::vector<MeshGroup> groups;  ///< at least one, in order, covering all triangles
  ImportReport report;
};

/// The mesh of a file; its format follows from its content, helped by the ending of its name.
Result<ImportedMesh> import_mesh(const std::string& path, const ImportOptions& options = {});

/// The same from bytes in memory. `name` gives the ending and the place in errors; files that a glTF refers
/// to are looked for beside it.
Result<ImportedMesh> import_mesh_bytes(std::string_view bytes, const std::string& name,
                                       const ImportOptions& options = {});

}  // namespace tactum
