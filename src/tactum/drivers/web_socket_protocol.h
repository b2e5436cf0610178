#pragma once
/// What both ends of a WebSocket have in common [RFC 6455]: the greeting, and the numbers of frames.

#include <cstddef>
#include <string>
#include <string_view>

namespace tactum::inline v0_1 {

/// Kinds of frames, and bits of a frame's first two bytes.
namespace ws {
inline constexpr int kContinuation = 0, kText = 1, kBinary = 2, kGoodbye = 8, kPing = 9, kPong = 10;
inline constexpr int kFirstControl = 8;
inline constexpr unsigned kLast = 0x80, kReserved = 0x70, kKind = 0x0f, kMasked = 0x80;
inline constexpr std::size_t kMostControl = 125;  ///< bytes of a frame that is no message
}  // namespace ws

/// A byte as a number.
inline unsigned octet(char c) noexcept { return static_cast<unsigned char>(c); }

inline constexpr std::size_t kMostWebSocketHead = 8192;  ///< of the greeting or its answer [bytes]

std::string base64(std::string_view bytes);

/// What a server answers to a client's key, so that both know the other speaks the protocol: the key and a
/// fixed text, through SHA-1, in base 64 [RFC 6455, 1.3].
std::string web_socket_accept(const std::string& key);

/// The value of a line of a head; empty when there is no such line. Names are written in any case.
std::string value_in_head(const std::string& head, const std::string& name);

/// Whether a list of words with commas between them, as of the line "Connection", holds a word, which is
/// given in small letters, in any case.
bool names_in_head(const std::string& value, std::string_view word);

}  // namespace tactum::inline v0_1
