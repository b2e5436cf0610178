#include "tactum/drivers/web_socket.h"

#include <algorithm>
#include <array>
#include <bit>
#include <random>

namespace tactum::inline v0_1 {
namespace {

// Kinds of frames.
constexpr int kWsContinuation = 0, kWsText = 1, kWsGoodbye = 8, kWsPing = 9, kWsPong = 10;
constexpr int kWsFirstControl = 8;
constexpr unsigned kWsLast = 0x80, kWsReserved = 0x70, kWsMasked = 0x80;
constexpr std::size_t kWsMostControl = 125;  // bytes of a frame that is no message
constexpr std::size_t kWsMostHead = 8192;    // of the answer to the greeting [bytes]

unsigned byte_of(char c) noexcept { return static_cast<unsigned char>(c); }

std::string base64(std::string_view bytes) {
  constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = std::min<std::size_t>(3, bytes.size() - i);
    unsigned group = 0;
    for (std::size_t j = 0; j < 3; ++j) group = group << 8 | (j < left ? byte_of(bytes[i + j]) : 0u);
    for (std::size_t j = 0; j < 4; ++j) text += j <= left ? kDigits[group >> (18 - 6 * j) & 63u] : '=';
  }
  return text;
}

/// One block of 64 bytes into the five words of the sum [FIPS 180-4, 6.1.2].
void sha1_block(const char* block, std::array<std::uint32_t, 5>& sum) noexcept {
  std::array<std::uint32_t, 80> w{};
  for (std::size_t i = 0; i < 16; ++i)
    for (std::size_t j = 0; j < 4; ++j) w[i] = w[i] << 8 | byte_of(block[4 * i + j]);
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

/// Sixteen bytes that no other client has.
std::string web_socket_key() {
  std::random_device random;
  std::string bytes;
  for (int i = 0; i < 16; ++i) bytes += static_cast<char>(random() & 0xff);
  return base64(bytes);
}

std::string lower(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

/// The value of a line of a head; empty when there is no such line. Names are written in any case.
std::string value_in_head(const std::string& head, const std::string& name) {
  const std::string line = "\r\n" + name + ":";
  const std::size_t at = lower(head).find(lower(line));
  if (at == std::string::npos) return "";
  const std::size_t from = head.find_first_not_of(' ', at + line.size());
  return head.substr(from, head.find("\r\n", from) - from);
}

}  // namespace

std::string web_socket_accept(const std::string& key) {
  return base64(sha1(key + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11"));
}

Result<void> WebSocket::connect(const std::string& host, int port, int timeout_ms) {
  close();
  const std::string place = "ws://" + host + ":" + std::to_string(port);
  if (Result<void> connected = stream_.connect(host, port, timeout_ms); !connected) return connected;
  const std::string key = web_socket_key();
  const bool sent =
      stream_.send("GET / HTTP/1.1\r\nHost: " + host + ":" + std::to_string(port) +
                       "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Key: " + key +
                       "\r\nSec-WebSocket-Version: 13\r\n\r\n",
                   timeout_ms);
  std::array<char, 4096> bytes{};
  while (sent && came_.find("\r\n\r\n") == std::string::npos && came_.size() < kWsMostHead) {
    const long got = stream_.receive(bytes.data(), bytes.size(), timeout_ms);
    if (got <= 0) break;
    came_.append(bytes.data(), static_cast<std::size_t>(got));
  }
  const std::size_t end = came_.find("\r\n\r\n");
  const std::string head = came_.substr(0, end == std::string::npos ? end : end + 2);
  const bool speaks = end != std::string::npos && head.starts_with("HTTP/1.1 101") &&
                      value_in_head(head, "Sec-WebSocket-Accept") == web_socket_accept(key);
  if (speaks) {
    came_.erase(0, end + 4);
    mask_ = std::random_device{}() | 1u;
    return {};
  }
  const std::string first = head.substr(0, std::min<std::size_t>(60, head.find("\r\n")));
  stream_.close();
  came_.clear();
  return Error{"what answers does not speak the WebSocket protocol", "'" + first + "'", "101 and our key",
               place};
}

void WebSocket::close() noexcept {
  if (stream_.is_open()) send_frame(kWsGoodbye, "", 0);
  stream_.close();
  came_.clear();
  message_.clear();
  in_message_ = false;
}

bool WebSocket::send_text(std::string_view text, int timeout_ms) {
  return send_frame(kWsText, text, timeout_ms);
}

bool WebSocket::send_frame(int kind, std::string_view bytes, int timeout_ms) {
  std::string frame;
  frame += static_cast<char>(kWsLast | static_cast<unsigned>(kind));
  const int long_bytes = bytes.size() < 126 ? 0 : bytes.size() < 65536 ? 2 : 8;
  const std::size_t short_size = long_bytes == 0 ? bytes.size() : long_bytes == 2 ? 126 : 127;
  frame += static_cast<char>(kWsMasked | short_size);
  for (int i = long_bytes - 1; i >= 0; --i) frame += static_cast<char>(bytes.size() >> (8 * i) & 0xff);
  // Each frame has another mask; a generator of Marsaglia's is enough, as nothing secret is sent.
  mask_ ^= mask_ << 13, mask_ ^= mask_ >> 17, mask_ ^= mask_ << 5;
  std::array<char, 4> mask{};
  for (std::size_t i = 0; i < 4; ++i) mask[i] = static_cast<char>(mask_ >> (8 * i) & 0xff);
  frame.append(mask.data(), mask.size());
  for (std::size_t i = 0; i < bytes.size(); ++i)
    frame += static_cast<char>(byte_of(bytes[i]) ^ byte_of(mask[i % 4]));
  return stream_.is_open() && stream_.send(frame, timeout_ms);
}

/// Takes a whole frame out of what has come; false when there is none yet.
bool WebSocket::take_frame(Frame& frame, std::string& bytes) {
  if (came_.size() < 2) return false;
  const unsigned size = byte_of(came_[1]) & ~kWsMasked;
  const std::size_t long_bytes = size == 126 ? 2 : size == 127 ? 8 : 0;
  if (came_.size() < 2 + long_bytes) return false;
  frame.size = long_bytes == 0 ? size : 0;
  for (std::size_t i = 0; i < long_bytes; ++i) frame.size = frame.size << 8 | byte_of(came_[2 + i]);
  frame.is_last = (byte_of(came_[0]) & kWsLast) != 0;
  frame.kind = static_cast<int>(byte_of(came_[0]) & 0xfu);
  if (frame.size > kMostBytes) return true;  // refused by its head
  if (came_.size() < 2 + long_bytes + frame.size) return false;
  bytes = came_.substr(2 + long_bytes, static_cast<std::size_t>(frame.size));
  came_.erase(0, 2 + long_bytes + static_cast<std::size_t>(frame.size));
  return true;
}

/// Pings and goodbyes; false when nothing comes after it.
bool WebSocket::take_control(const Frame& frame, const std::string& bytes, int timeout_ms) {
  if (frame.size > kWsMostControl || !frame.is_last) return false;
  if (frame.kind == kWsPing) return send_frame(kWsPong, bytes, timeout_ms);
  return frame.kind == kWsPong;
}

WebSocket::Came WebSocket::add_frame(const Frame& frame, const std::string& bytes, std::string& text) {
  const bool fits = message_.size() + frame.size <= kMostBytes;
  const bool in_order = frame.kind == (in_message_ ? kWsContinuation : kWsText);
  if (!fits || !in_order) return Came::kEnd;
  message_ += bytes;
  in_message_ = !frame.is_last;
  if (in_message_) return Came::kNothing;
  text.swap(message_);
  message_.clear();
  return Came::kMessage;
}

WebSocket::Came WebSocket::receive_text(std::string& text, int timeout_ms) {
  std::array<char, 16384> bytes{};
  for (;;) {
    Frame frame;
    std::string payload;
    const bool refused =
        came_.size() >= 2 && ((byte_of(came_[0]) & kWsReserved) != 0 || (byte_of(came_[1]) & kWsMasked) != 0);
    if (refused) return Came::kEnd;
    if (take_frame(frame, payload)) {
      if (frame.kind >= kWsFirstControl) {
        if (!take_control(frame, payload, timeout_ms)) return Came::kEnd;
        continue;
      }
      const Came came = add_frame(frame, payload, text);
      if (came != Came::kNothing) return came;
      continue;
    }
    const long got = stream_.receive(bytes.data(), bytes.size(), timeout_ms);
    if (got == 0) return Came::kNothing;
    if (got < 0) return Came::kEnd;
    came_.append(bytes.data(), static_cast<std::size_t>(got));
  }
}

}  // namespace tactum::inline v0_1
