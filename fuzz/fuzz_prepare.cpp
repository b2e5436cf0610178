/// Small meshes of any shape through the whole of preparation: each byte is a coordinate or a corner, so that
/// repeated places, flat and folded triangles and edges of many triangles come easily.

#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "tactum/base/tolerances.h"
#include "tactum/mesh/prepare_part.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tactum;
  if (size < 3) return 0;
  const int vertices = 3 + data[0] % 24;
  PrepareOptions options;
  options.name = "fuzzed";
  options.unit = "m";
  options.close_holes = data[1] % 12;
  options.area_samples = 60;  // corners and sides are there in any case; a full grid takes most of a second
  data += 2;
  size -= 2;
  ImportedMesh mesh;
  for (int v = 0; v < vertices && size >= 3; ++v, data += 3, size -= 3)
    mesh.mesh.vertices.emplace_back(data[0] / 16.0, data[1] / 16.0, data[2] / 16.0);
  const int count = static_cast<int>(mesh.mesh.vertices.size());
  for (; count > 0 && size >= 3; data += 3, size -= 3)
    mesh.mesh.triangles.push_back({data[0] % count, data[1] % count, data[2] % count});
  const int triangles = static_cast<int>(mesh.mesh.triangles.size());
  if (triangles == 0) return 0;
  if (triangles > 4) {
    mesh.groups = {{"one", 0, triangles / 2}, {"two", triangles / 2, triangles - triangles / 2}};
  } else {
    mesh.groups = {{"all", 0, triangles}};
  }
  const Result<PartFile> part = prepare_part(mesh, options);
  if (!part) {
    if (part.error().message().empty()) std::abort();
    return 0;
  }
  const std::string bytes = part_bytes(*part);
  const Result<PartFile> back = read_part(bytes, "fuzzed.tactum");
  if (!back || part_bytes(*back) != bytes) std::abort();
  return 0;
}
