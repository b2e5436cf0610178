#include "tactum/drivers/web_socket_protocol.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

namespace tactum::inline v0_1 {
namespace {

/// One block of 64 bytes into the five words of the sum [FIPS 180-4, 6.1.2].
void sha1_block(const char* block, std::array<std::uint32_t, 5>& sum) noexcept {
  std::array<std::uint32_t, 80> w{};
  for (std::size_t i = 0; i < 16; ++i)
    for (std::size_t j = 0; j < 4; ++j) w[i] = w[i] << 8 | octet(block[4 * i + j]);
  for (std::size_t i = 16; i < 80; ++i) w[i] = std::rotl(w[i - 3] ^ w[i - 8] ^ w[i - 14] ^ w[i - 16], 1);
  auto [a, b, c, d, e] = sum;
  for (std::size_t i = 0; i < 80; ++i) {
    const std::uint32_t mixed = i < 20   ? ((b & c) | (~b & d)) + 0x5A827999u
                                : i < 40 ? (b ^ c ^ d) + 0x6ED9EBA1u
                                : i < 60 ? ((b & c) | (b & d) | (c & d)) + 0x8F1BBCDCu
                                         : (b ^ c ^ d) + 0xCA62C1D6u;
    const std::uint32_t next = std::rotl(a, 5) + mixed + e + w[i];
    e = d, d = c, c = std::rotl(b, 30), b = a, a = next;
  }
  const std::array<std::uint32_t, 5> added{a, b, c, d, e};
  for (std::size_t i = 0; i < 5; ++i) sum[i] += added[i];
}

std::string sha1(std::string text) {
  const std::uint64_t bits = 8 * static_cast<std::uint64_t>(text.size());
  text += static_cast<char>(0x80);
  while (text.size() % 64 != 56) text += '\0';
  for (int shift = 56; shift >= 0; shift -= 8) text += static_cast<char>(bits >> shift & 0xff);
  std::array<std::uint32_t, 5> sum{0x67452301u, 0xEFCDAB89u, 0x98BADCFEu, 0x10325476u, 0xC3D2E1F0u};
  for (std::size_t at = 0; at < text.size(); at += 64) sha1_block(text.data() + at, sum);
  std::string bytes;
  for (const std::uint32_t word : sum)
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(word >> shift & 0xff);
  return bytes;
}

std::string lower(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

}  // namespace

std::string base64(std::string_view bytes) {
  constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = std::min<std::size_t>(3, bytes.size() - i);
    unsigned group = 0;
    for (std::size_t j = 0; j < 3; ++j) group = group << 8 | (j < left ? octet(bytes[i + j]) : 0u);
    for (std::size_t j = 0; j < 4; ++j) text += j <= left ? kDigits[group >> (18 - 6 * j) & 63u] : '=';
  }
  return text;
}

std::string value_in_head(const std::string& head, const std::string& name) {
  const std::string line = "\r\n" + name + ":";
  const std::size_t at = lower(head).find(lower(line));
  if (at == std::string::npos) return "";
  const std::size_t from = head.find_first_not_of(' ', at + line.size());
  return head.substr(from, head.find("\r\n", from) - from);
}

bool names_in_head(const std::string& value, std::string_view word) {
  const std::string words = "," + lower(value) + ",";
  for (std::size_t at = words.find(word); at != std::string::npos; at = words.find(word, at + 1)) {
    const std::size_t before = words.find_last_not_of(" \t", at - 1);
    const std::size_t behind = words.find_first_not_of(" \t", at + word.size());
    if (words[before] == ',' && words[behind] == ',') return true;
  }
  return false;
}

std::string web_socket_accept(const std::string& key) {
  return base64(sha1(key + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11"));
}

}  // namespace tactum::inline v0_1
