#pragma once
/// The cyclic redundancy check of zip and MCAP files: polynomial 0x04C11DB7, reflected, begun and ended with
/// all bits turned. It finds every single flipped byte; it is no protection against intent.

#include <cstdint>
#include <string_view>

namespace tactum::inline v0_1 {

/// Of bytes that come in parts: the value of each call is `so_far` of the next, which begins with 0. About
/// 1 ns a byte.
std::uint32_t crc32(std::string_view bytes, std::uint32_t so_far = 0) noexcept;

}  // namespace tactum::inline v0_1
