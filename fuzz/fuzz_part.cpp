/// Any bytes as a part file: once as they are, and once with the size and checksum they would have, so that
/// what lies behind the checksum is reached.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "support/reseal.h"
#include "tactum/mesh/part_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tactum;
  std::string bytes(reinterpret_cast<const char*>(data), size);
  [[maybe_unused]] const Result<PartFile> as_it_is = read_part(bytes, "fuzzed.tactum");
  testing::reseal(bytes);
  const Result<PartFile> part = read_part(bytes, "fuzzed.tactum");
  if (!part) {
    if (part.error().message().empty()) std::abort();
    return 0;
  }
  for (const Polytope& piece : part->part.pieces) {
    const int vertex = support_vertex(piece, Vec3(1, 2, 3));
    if (vertex < 0 || vertex >= static_cast<int>(piece.vertices.size())) std::abort();
  }
  if (!read_part(part_bytes(*part), "again.tactum")) std::abort();
  return 0;
}
