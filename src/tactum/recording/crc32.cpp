#include "tactum/recording/crc32.h"

#include <array>
#include <cstddef>

namespace tactum::inline v0_1 {
namespace {

constexpr int kSlices = 8;

/// The check of a byte that is followed by `slice` zeros.
consteval std::array<std::array<std::uint32_t, 256>, kSlices> crc_tables() {
  constexpr std::uint32_t kReflected = 0xEDB88320u;
  std::array<std::array<std::uint32_t, 256>, kSlices> tables{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t value = byte;
    for (int bit = 0; bit < 8; ++bit) value = (value & 1u) != 0 ? (value >> 1) ^ kReflected : value >> 1;
    tables[0][byte] = value;
  }
  for (std::size_t slice = 1; slice < kSlices; ++slice)
    for (std::size_t byte = 0; byte < 256; ++byte) {
      const std::uint32_t before = tables[slice - 1][byte];
      tables[slice][byte] = (before >> 8) ^ tables[0][before & 0xFFu];
    }
  return tables;
}

constexpr auto kTables = crc_tables();

}  // namespace

std::uint32_t crc32(std::string_view bytes, std::uint32_t so_far) noexcept {
  std::uint32_t value = ~so_far;
  const auto at = [&](std::size_t i) {
    return static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[i]));
  };
  std::size_t i = 0;
  for (; i + kSlices <= bytes.size(); i += kSlices) {
    value ^= at(i) | at(i + 1) << 8 | at(i + 2) << 16 | at(i + 3) << 24;
    value = kTables[7][value & 0xFFu] ^ kTables[6][(value >> 8) & 0xFFu] ^ kTables[5][(value >> 16) & 0xFFu] ^
            kTables[4][value >> 24] ^ kTables[3][at(i + 4)] ^ kTables[2][at(i + 5)] ^ kTables[1][at(i + 6)] ^
            kTables[0][at(i + 7)];
  }
  for (; i < bytes.size(); ++i) value = (value >> 8) ^ kTables[0][(value ^ at(i)) & 0xFFu];
  return ~value;
}

}  // namespace tactum::inline v0_1
