#pragma once
/// Chunks made smaller by zstd, and back.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace tactum::inline v0_1 {

/// As MCAP calls it.
inline constexpr std::string_view kCompression = "zstd";

/// About 3 ns a byte.
std::string compressed(std::string_view bytes);

/// The bytes again: exactly `size` of them, or nothing where the packed ones are not that. Never takes more
/// memory than `size`.
std::optional<std::string> decompressed(std::string_view packed, std::size_t size);

}  // namespace tactum::inline v0_1
