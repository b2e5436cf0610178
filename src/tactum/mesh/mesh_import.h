#pragma once
/// Meshes from files: OBJ, STL and PLY (text and binary), OFF, glTF and GLB, COLLADA.
///
/// Text and the simple binary formats are read by our own readers: they keep the file's doubles (assimp
/// stores single precision), split concave polygons correctly (a fan would fold over), give the line or byte
/// where a file is wrong, and are bounded: no count from the file is trusted before the bytes for it are
/// seen. glTF goes through assimp, but only after its structure was checked and everything that is not
/// geometry taken out (gltf_check.h).
///
/// Vertices and triangles come as the file has them, not welded (see weld.h). No exception leaves these
/// functions.

#include <string>
#include <string_view>

#include "tactum/base/result.h"
#include "tactum/geometry/mesh_report.h"
#include "tactum/mesh/imported_mesh.h"

namespace tactum::inline v0_1 {

/// The mesh of a file; its format is recognised by its content, helped by the ending of its name.
Result<ImportedMesh> import_mesh(const std::string& path, const ImportOptions& options = {});

/// The same from bytes in memory. `name` gives the ending and the place in errors; files that a glTF refers
/// to are searched beside it.
Result<ImportedMesh> import_mesh_bytes(std::string_view bytes, const std::string& name,
                                       const ImportOptions& options = {});

/// The unit of the file's numbers: the one that its format has by its standard, else a guess from the box,
/// which is in the units of the file.
UnitGuess unit_of(const ImportReport& report, const Aabb& box);

}  // namespace tactum::inline v0_1
