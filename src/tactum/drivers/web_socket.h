#pragma once
/// A client of the WebSocket protocol [RFC 6455], for text messages over a connection without encryption.
/// Extensions are not asked for; a server's pings are answered; a message may come in several frames.
///
/// For one thread at a time. Messages are allocated: not for the loop's thread.

#include <cstdint>
#include <string>
#include <string_view>

#include "tactum/drivers/tcp_stream.h"

namespace tactum::inline v0_1 {

class WebSocket {
 public:
  static constexpr std::size_t kMostBytes = 1 << 20;  ///< of a message that is taken [bytes]

  enum class Came { kMessage, kNothing, kEnd };

  WebSocket() = default;
  ~WebSocket() { close(); }
  WebSocket(const WebSocket&) = delete;
  WebSocket& operator=(const WebSocket&) = delete;

  /// Connects and greets. Each wait takes at most `timeout_ms`.
  Result<void> connect(const std::string& host, int port, int timeout_ms);
  /// Says goodbye, without waiting for the answer. Safe to call twice.
  void close() noexcept;
  bool is_open() const noexcept { return stream_.is_open(); }

  /// False when it cannot be sent within `timeout_ms`; the connection is then useless.
  bool send_text(std::string_view text, int timeout_ms);
  /// The next message; kNothing when none came in time, kEnd when the server said goodbye, is gone, or sends
  /// what breaks the protocol. Each wait for bytes takes at most `timeout_ms`.
  Came receive_text(std::string& text, int timeout_ms);

 private:
  /// The head of a frame; `size` bytes follow it.
  struct Frame {
    bool is_last = false;
    int kind = 0;
    std::uint64_t size = 0;
  };
  bool send_frame(int kind, std::string_view bytes, int timeout_ms);
  bool take_frame(Frame& frame, std::string& bytes);
  bool take_control(const Frame& frame, const std::string& bytes, int timeout_ms);
  Came add_frame(const Frame& frame, const std::string& bytes, std::string& text);

  TcpStream stream_;
  std::string came_;     // bytes that are not yet a whole frame
  std::string message_;  // of the frames so far
  bool in_message_ = false;
  std::uint32_t mask_ = 0;
};

}  // namespace tactum::inline v0_1
