#pragma once
/// A glTF reduced to its geometry. assimp has a record of memory faults on broken files, so it never sees
/// one: this reads the JSON, checks every count, offset and index that positions and triangles hang on, and
/// writes a fresh GLB with nothing but scenes, nodes, meshes, positions as floats and triangles by indices
/// (gltf_accessors.h reads them). Extensions a file cannot do without (Draco and kin) and glTF 1.0 are
/// refused with a sentence.

#include <string>
#include <string_view>

#include "tactum/mesh/mesh_builder.h"

namespace tactum::inline v0_1::detail {

/// The bytes of the reduced GLB; points and lines are counted in the builder's report.
Result<std::string> reduced_glb(std::string_view bytes, MeshBuilder& builder);

}  // namespace tactum::inline v0_1::detail
