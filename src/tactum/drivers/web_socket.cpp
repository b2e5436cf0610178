#include "tactum/drivers/web_socket.h"

#include <algorithm>
#include <array>
#include <random>

#include "tactum/drivers/web_socket_protocol.h"

namespace tactum::inline v0_1 {
namespace {

/// Sixteen bytes that no other client has.
std::string web_socket_key() {
  std::random_device random;
  std::string bytes;
  for (int i = 0; i < 16; ++i) bytes += static_cast<char>(random() & 0xff);
  return base64(bytes);
}

}  // namespace

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
  while (sent && came_.find("\r\n\r\n") == std::string::npos && came_.size() < kMostWebSocketHead) {
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
  if (stream_.is_open()) send_frame(ws::kGoodbye, "", 0);
  stream_.close();
  came_.clear();
  message_.clear();
  in_message_ = false;
}

bool WebSocket::send_text(std::string_view text, int timeout_ms) {
  return send_frame(ws::kText, text, timeout_ms);
}

bool WebSocket::send_frame(int kind, std::string_view bytes, int timeout_ms) {
  std::string frame;
  frame += static_cast<char>(ws::kLast | static_cast<unsigned>(kind));
  const int long_bytes = bytes.size() < 126 ? 0 : bytes.size() < 65536 ? 2 : 8;
  const std::size_t short_size = long_bytes == 0 ? bytes.size() : long_bytes == 2 ? 126 : 127;
  frame += static_cast<char>(ws::kMasked | short_size);
  for (int i = long_bytes - 1; i >= 0; --i) frame += static_cast<char>(bytes.size() >> (8 * i) & 0xff);
  // Each frame has another mask; a generator of Marsaglia's is enough, as nothing secret is sent.
  mask_ ^= mask_ << 13, mask_ ^= mask_ >> 17, mask_ ^= mask_ << 5;
  std::array<char, 4> mask{};
  for (std::size_t i = 0; i < 4; ++i) mask[i] = static_cast<char>(mask_ >> (8 * i) & 0xff);
  frame.append(mask.data(), mask.size());
  for (std::size_t i = 0; i < bytes.size(); ++i)
    frame += static_cast<char>(octet(bytes[i]) ^ octet(mask[i % 4]));
  return stream_.is_open() && stream_.send(frame, timeout_ms);
}

/// Takes a whole frame out of what has come; false when there is none yet.
bool WebSocket::take_frame(Frame& frame, std::string& bytes) {
  if (came_.size() < 2) return false;
  const unsigned size = octet(came_[1]) & ~ws::kMasked;
  const std::size_t long_bytes = size == 126 ? 2 : size == 127 ? 8 : 0;
  if (came_.size() < 2 + long_bytes) return false;
  frame.size = long_bytes == 0 ? size : 0;
  for (std::size_t i = 0; i < long_bytes; ++i) frame.size = frame.size << 8 | octet(came_[2 + i]);
  frame.is_last = (octet(came_[0]) & ws::kLast) != 0;
  frame.kind = static_cast<int>(octet(came_[0]) & ws::kKind);
  if (frame.size > kMostBytes) return true;  // refused by its head
  if (came_.size() < 2 + long_bytes + frame.size) return false;
  bytes = came_.substr(2 + long_bytes, static_cast<std::size_t>(frame.size));
  came_.erase(0, 2 + long_bytes + static_cast<std::size_t>(frame.size));
  return true;
}

/// Pings and goodbyes; false when nothing comes after it.
bool WebSocket::take_control(const Frame& frame, const std::string& bytes, int timeout_ms) {
  if (frame.size > ws::kMostControl || !frame.is_last) return false;
  if (frame.kind == ws::kPing) return send_frame(ws::kPong, bytes, timeout_ms);
  return frame.kind == ws::kPong;
}

WebSocket::Came WebSocket::add_frame(const Frame& frame, const std::string& bytes, std::string& text) {
  const bool fits = message_.size() + frame.size <= kMostBytes;
  const bool in_order = frame.kind == (in_message_ ? ws::kContinuation : ws::kText);
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
        came_.size() >= 2 && ((octet(came_[0]) & ws::kReserved) != 0 || (octet(came_[1]) & ws::kMasked) != 0);
    if (refused) return Came::kEnd;
    if (take_frame(frame, payload)) {
      if (frame.kind >= ws::kFirstControl) {
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
