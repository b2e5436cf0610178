#include "tactum/drivers/web_socket_link.h"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>

#include "tactum/drivers/datagram_socket.h"
#include "tactum/drivers/web_socket_protocol.h"

namespace tactum::inline v0_1 {
namespace {

constexpr int kMostDiscarded = 1000;  // at once
constexpr double kGreetWithin_s = 1.0;
constexpr double kEndWithin_s = 0.2;  // a client answers a goodbye
constexpr int kMostUnsent = 16384;  // commands of a tenth of a second at 1 kHz wait for a slow client [bytes]

double link_clock_s() noexcept {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

bool is_own_origin(const std::string& origin, const std::string& our_address) {
  if (origin.empty()) return true;
  const std::size_t scheme = origin.find("://");
  if (scheme == std::string::npos) return false;
  std::string host = origin.substr(scheme + 3);
  const std::size_t bracket = host.find(']');  // the end of an address of version 6
  const std::size_t colon = host.find(':', bracket == std::string::npos ? 0 : bracket);
  host = host.substr(0, colon);
  return host == "localhost" || host == "127.0.0.1" || host == "[::1]" || host == our_address;
}

Result<void> WebSocketLink::listen(const std::string& address, int port) {
  constexpr int kMostWaiting = 4;  // clients
  close();
  address_ = address;
  listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const int on = 1;
  if (listener_ >= 0) ::setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  Result<void> listens =
      listen_at(listener_, address, port, kMostWaiting, "cannot listen for a device over WebSocket");
  if (!listens) close();
  return listens;
}

void WebSocketLink::stop_listening() noexcept {
  if (listener_ >= 0) ::close(listener_);
  listener_ = -1;
}

void WebSocketLink::close() noexcept {
  drop_client();
  stop_listening();
}

void WebSocketLink::drop_client() noexcept {
  if (client_ >= 0) {
    if (is_greeted_ && !has_ended_) send_frame(ws::kGoodbye, nullptr, 0);
    ::shutdown(client_, SHUT_WR);
    if (is_greeted_ && !has_ended_) wait_for_end();
    ::close(client_);
  }
  client_ = -1;
  is_greeted_ = false;
  has_ended_ = false;
  in_message_ = false;
  begin_ = end_ = message_size_ = rest_size_ = 0;
}

/// Takes what still comes, until the client has closed its end. A connection that is closed with something of
/// the client's left is reset, and the client then loses what it had not yet read: the last commands.
void WebSocketLink::wait_for_end() noexcept {
  for (const double until_s = link_clock_s() + kEndWithin_s; link_clock_s() < until_s;) {
    pollfd waiting{client_, POLLIN, 0};
    if (::poll(&waiting, 1, 1) <= 0) continue;
    begin_ = end_ = 0;
    if (!fill()) return;
  }
}

void WebSocketLink::serve() {
  if (has_ended_) drop_client();
  take_client();
  if (client_ >= 0 && !is_greeted_) take_greeting();
}

void WebSocketLink::take_client() {
  const bool is_busy = client_ >= 0 && link_clock_s() - came_s_ < kGreetWithin_s;
  if (listener_ < 0 || is_busy) return;
  const int next = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (next < 0) return;
  drop_client();
  const int on = 1;
  ::setsockopt(next, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  ::setsockopt(next, SOL_SOCKET, SO_SNDBUF, &kMostUnsent, sizeof kMostUnsent);
  client_ = next;
  came_s_ = link_clock_s();
  head_.clear();
}

/// A client sends nothing after its greeting before it is answered, so what came is the greeting alone.
void WebSocketLink::take_greeting() {
  if (!fill()) has_ended_ = true;
  head_.append(came_.data() + begin_, end_ - begin_);
  begin_ = end_ = 0;
  if (has_ended_ || head_.size() > kMostWebSocketHead) {
    drop_client();
    return;
  }
  if (!head_.ends_with("\r\n\r\n")) return;
  const std::string refused = refusal();
  const std::string answer =
      refused.empty() ? "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                        "Sec-WebSocket-Accept: " +
                            web_socket_accept(value_in_head(head_, "Sec-WebSocket-Key")) + "\r\n\r\n"
                      : "HTTP/1.1 " + refused + "\r\nSec-WebSocket-Version: 13\r\nConnection: close\r\n\r\n";
  const bool sent =
      ::send(client_, answer.data(), answer.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(answer.size());
  is_greeted_ = sent && refused.empty();
  if (!refused.empty()) last_refusal_ = refused;
  if (!is_greeted_) drop_client();
}

/// Why the greeting is not answered with a connection, as the status of the answer; empty when it is.
std::string WebSocketLink::refusal() const {
  if (!head_.starts_with("GET ") || !names_in_head(value_in_head(head_, "Upgrade"), "websocket") ||
      !names_in_head(value_in_head(head_, "Connection"), "upgrade") ||
      value_in_head(head_, "Sec-WebSocket-Key").empty())
    return "400 A WebSocket Is Served Here";
  if (value_in_head(head_, "Sec-WebSocket-Version") != "13") return "426 Version 13 Is Served";
  if (!is_own_origin(value_in_head(head_, "Origin"), address_)) return "403 Only Pages Of This Machine";
  return "";
}

/// Takes what has come, as far as there is room; false when the client is gone.
bool WebSocketLink::fill() noexcept {
  if (begin_ > 0) std::memmove(came_.data(), came_.data() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
  const ssize_t got = ::recv(client_, came_.data() + end_, came_.size() - end_, MSG_DONTWAIT);
  if (got > 0) end_ += static_cast<std::size_t>(got);
  return got > 0 || (got < 0 && (errno == EAGAIN || errno == EINTR));
}

/// Whether a frame has come as a whole. What breaks the protocol ends the link.
bool WebSocketLink::next_frame(Frame& frame) noexcept {
  constexpr std::size_t kMask = 4;
  const char* bytes = came_.data() + begin_;
  const std::size_t have = end_ - begin_;
  if (have < 2) return false;
  const unsigned size = octet(bytes[1]) & ~ws::kMasked;
  if ((octet(bytes[0]) & ws::kReserved) != 0 || (octet(bytes[1]) & ws::kMasked) == 0 || size == 127) {
    has_ended_ = true;
    return false;
  }
  frame.is_last = (octet(bytes[0]) & ws::kLast) != 0;
  frame.kind = static_cast<int>(octet(bytes[0]) & ws::kKind);
  frame.head = (size == 126 ? 4 : 2) + kMask;
  if (have < frame.head) return false;
  frame.size = size == 126 ? octet(bytes[2]) << 8 | octet(bytes[3]) : size;
  if (frame.size > kMostMessage) has_ended_ = true;
  return !has_ended_ && have >= frame.head + frame.size;
}

/// Takes a frame's bytes off; whether they end a message.
bool WebSocketLink::take_frame(const Frame& frame) noexcept {
  char* bytes = came_.data() + begin_ + frame.head;
  const char* mask = bytes - 4;
  for (std::size_t i = 0; i < frame.size; ++i)
    bytes[i] = static_cast<char>(octet(bytes[i]) ^ octet(mask[i % 4]));
  begin_ += frame.head + frame.size;
  if (frame.kind >= ws::kFirstControl) {
    const bool is_known = frame.kind == ws::kPing || frame.kind == ws::kPong;
    if (!is_known || !frame.is_last || frame.size > ws::kMostControl)
      has_ended_ = true;
    else if (frame.kind == ws::kPing)
      send_frame(ws::kPong, bytes, frame.size);
    return false;
  }
  const bool is_in_order = frame.kind == (in_message_ ? ws::kContinuation : ws::kBinary);
  if (!is_in_order || message_size_ + frame.size > kMostMessage) {
    has_ended_ = true;
    return false;
  }
  std::memcpy(message_.data() + message_size_, bytes, frame.size);
  message_size_ += frame.size;
  in_message_ = !frame.is_last;
  return frame.is_last;
}

long WebSocketLink::receive(void* bytes, std::size_t room) noexcept {
  if (taking_.test_and_set(std::memory_order_acquire)) return -1;
  const long size = take_message(bytes, room);
  taking_.clear(std::memory_order_release);
  return size;
}

bool WebSocketLink::discard() noexcept {
  int discarded = 0;
  while (discarded < kMostDiscarded && receive(nullptr, 0) >= 0) ++discarded;
  return discarded > 0;
}

long WebSocketLink::take_message(void* bytes, std::size_t room) noexcept {
  while (is_greeted_ && !has_ended_) {
    Frame frame;
    if (next_frame(frame)) {
      if (!take_frame(frame)) continue;
      const std::size_t size = message_size_;
      if (room > 0) std::memcpy(bytes, message_.data(), std::min(room, size));
      message_size_ = 0;
      return static_cast<long>(size);
    }
    const std::size_t before = end_ - begin_;
    if (!has_ended_ && !fill()) has_ended_ = true;
    if (end_ - begin_ == before) break;
  }
  return -1;
}

void WebSocketLink::send(const void* bytes, std::size_t size) noexcept {
  if (is_greeted_ && !has_ended_ && size <= kMostMessage) send_frame(ws::kBinary, bytes, size);
}

/// Sends what is left of the last frame; false when some of it still is.
bool WebSocketLink::flush() noexcept {
  if (rest_size_ == 0) return true;
  const ssize_t sent = ::send(client_, rest_.data(), rest_size_, MSG_DONTWAIT | MSG_NOSIGNAL);
  if (sent < 0) {
    if (errno != EAGAIN && errno != EINTR) has_ended_ = true;
    return false;
  }
  rest_size_ -= static_cast<std::size_t>(sent);
  std::memmove(rest_.data(), rest_.data() + sent, rest_size_);
  return rest_size_ == 0;
}

void WebSocketLink::send_frame(int kind, const void* bytes, std::size_t size) noexcept {
  if (sending_.test_and_set(std::memory_order_acquire)) return;
  if (flush()) {
    rest_[0] = static_cast<char>(ws::kLast | static_cast<unsigned>(kind));
    std::size_t head = 2;
    if (size < 126) {
      rest_[1] = static_cast<char>(size);
    } else {
      rest_[1] = 126;
      rest_[2] = static_cast<char>(size >> 8 & 0xff);
      rest_[3] = static_cast<char>(size & 0xff);
      head = 4;
    }
    if (size > 0) std::memcpy(rest_.data() + head, bytes, size);
    rest_size_ = head + size;
    const ssize_t sent = ::send(client_, rest_.data(), rest_size_, MSG_DONTWAIT | MSG_NOSIGNAL);
    if (sent < 0 && errno != EAGAIN && errno != EINTR) has_ended_ = true;
    const std::size_t taken = sent < 0 ? 0 : static_cast<std::size_t>(sent);
    // A frame of which nothing is on its way yet is lost; of one that is, the rest follows.
    rest_size_ = taken == 0 ? 0 : rest_size_ - taken;
    std::memmove(rest_.data(), rest_.data() + taken, rest_size_);
  }
  sending_.clear(std::memory_order_release);
}

}  // namespace tactum::inline v0_1
