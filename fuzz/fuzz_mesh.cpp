/// Any bytes as a mesh file. The first byte chooses the ending of the name, the rest is the file.

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "tactum/geometry/mesh_report.h"
#include "tactum/mesh/mesh_import.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tactum;
  constexpr std::array<const char*, 7> kNames = {"a.obj",  "a.stl", "a.ply", "a.off",
                                                 "a.gltf", "a.glb", "a.dae"};
  if (size == 0) return 0;
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  const Result<ImportedMesh> mesh = import_mesh_bytes(bytes, kNames[data[0] % kNames.size()]);
  if (!mesh) {
    if (mesh.error().message().empty()) std::abort();
    return 0;
  }
  const int vertices = static_cast<int>(mesh->mesh.vertices.size());
  for (const Triangle& t : mesh->mesh.triangles)
    for (int corner : t)
      if (corner < 0 || corner >= vertices) std::abort();
  if (mesh->mesh.triangles.empty() || mesh->groups.empty()) std::abort();
  report_mesh(mesh->mesh);
  return 0;
}
