#include "tactum/recording/compression.h"

#include <zstd.h>

#include "tactum/base/assert.h"

namespace tactum::inline v0_1 {

std::string compressed(std::string_view bytes) {
  constexpr int kLevel = 3;  // of 1 to 19; beyond it only the time grows
  std::string packed(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size = ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), kLevel);
  TACTUM_DEMAND(ZSTD_isError(size) == 0);  // there is always room
  packed.resize(size);
  return packed;
}

std::optional<std::string> decompressed(std::string_view packed, std::size_t size) {
  // A frame tells its size, or the name of a thing that is larger than it: nothing is set aside before.
  if (ZSTD_getFrameContentSize(packed.data(), packed.size()) != size) return {};
  std::string bytes(size, '\0');
  if (ZSTD_decompress(bytes.data(), size, packed.data(), packed.size()) != size) return {};
  return bytes;
}

}  // namespace tactum::inline v0_1
