#pragma once
/// A part file whose bytes were changed gets the size and checksum it would have had, so that what lies
/// behind the checksum is tested too. Written from the picture in array_file.h, not with its code.

#include <cstdint>
#include <cstring>
#include <string>

namespace tactum::testing {

inline void reseal(std::string& bytes) {
  constexpr std::size_t kSizeAt = 16;
  constexpr std::size_t kChecksumAt = 24;
  constexpr std::size_t kHeader = 32;
  if (bytes.size() < kHeader) return;
  const std::uint64_t size = bytes.size();
  std::memcpy(bytes.data() + kSizeAt, &size, sizeof size);
  std::memset(bytes.data() + kChecksumAt, 0, sizeof size);
  std::uint64_t hash = 14695981039346656037ull;
  for (const char byte : bytes) hash = (hash ^ static_cast<unsigned char>(byte)) * 1099511628211ull;
  std::memcpy(bytes.data() + kChecksumAt, &hash, sizeof hash);
}

}  // namespace tactum::testing
