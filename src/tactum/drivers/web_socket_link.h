#pragma once
/// The server's end of one WebSocket [RFC 6455], for short binary messages, without encryption: by it a page
/// of a browser or a script joins (network_device.h). A greeting is taken and answered before the loop runs;
/// from then on nothing is allocated and nothing waits. A message may come in several frames; pings are
/// answered.
///
/// Every page of the web may ask a browser to connect to this machine, and the browser says whose page it is.
/// Only pages of this machine are let in, and programs, which say nothing.
///
/// Messages are sent from any thread, and taken by one; another may throw away what that one does not take.

#include <array>
#include <atomic>
#include <cstddef>
#include <string>

#include "tactum/base/result.h"

namespace tactum::inline v0_1 {

/// Whether what a greeting says of its page, "http://localhost:8000", is a page of this machine, or of the
/// address at which we listen; so is an empty text, of programs. "null", of pages without a place, is not.
bool is_own_origin(const std::string& origin, const std::string& our_address);

class WebSocketLink {
 public:
  static constexpr std::size_t kMostMessage = 1024;  ///< that is taken or sent [bytes]

  WebSocketLink() = default;
  ~WebSocketLink() { close(); }
  WebSocketLink(const WebSocketLink&) = delete;
  WebSocketLink& operator=(const WebSocketLink&) = delete;

  /// Listens at an IPv4 address of this machine. The error says when another program has the port.
  Result<void> listen(const std::string& address, int port);
  /// Takes no further client, and keeps the one there is.
  void stop_listening() noexcept;
  /// Says goodbye to the client, waits a fifth of a second at most for its answer, and stops listening. Safe
  /// to call twice.
  void close() noexcept;

  /// Takes who comes, one at a time, and answers a greeting that is whole; may allocate. A client that is not
  /// done with its greeting, or was left unused, within a second gives way to the next.
  void serve();
  bool is_greeted() const noexcept { return is_greeted_; }
  /// Why the last client that was refused was; empty when none was.
  const std::string& last_refusal() const noexcept { return last_refusal_; }
  /// The client said goodbye, is gone, or broke the protocol.
  bool has_ended() const noexcept { return has_ended_; }
  /// What can be waited for with poll: -1 where there is none.
  int listener() const noexcept { return listener_; }
  int client() const noexcept { return client_; }

  /// Takes one message, without waiting; its size, which may be more than there was room for, or -1 when none
  /// is there, or another thread is taking.
  long receive(void* bytes, std::size_t room) noexcept;
  /// Throws away the messages that have come, so that a client is not held up in sending; whether there were
  /// any. From any thread.
  bool discard() noexcept;
  /// Sends a message, without waiting. What cannot be sent now, since the client takes nothing or another
  /// thread is sending, is lost as a whole.
  void send(const void* bytes, std::size_t size) noexcept;

 private:
  /// A frame's head; `size` bytes follow the `head` bytes.
  struct Frame {
    bool is_last = false;
    int kind = 0;
    std::size_t head = 0, size = 0;
  };
  void take_client();
  void drop_client() noexcept;
  void wait_for_end() noexcept;
  void take_greeting();
  std::string refusal() const;
  bool fill() noexcept;
  bool next_frame(Frame& frame) noexcept;
  bool take_frame(const Frame& frame) noexcept;
  long take_message(void* bytes, std::size_t room) noexcept;
  void send_frame(int kind, const void* bytes, std::size_t size) noexcept;
  bool flush() noexcept;

  std::string address_;
  int listener_ = -1, client_ = -1;
  double came_s_ = 0.0;  // when the client did, on the steady clock
  std::string head_;     // of the greeting, so far
  std::string last_refusal_;
  bool is_greeted_ = false;
  std::atomic<bool> has_ended_{false};
  std::atomic_flag taking_ = ATOMIC_FLAG_INIT;
  // Bytes that came and are not yet taken, from begin_ to end_.
  std::array<char, 4096> came_{};
  std::size_t begin_ = 0, end_ = 0;
  std::array<char, kMostMessage> message_{};  // of the frames so far
  std::size_t message_size_ = 0;
  bool in_message_ = false;
  // The end of a frame of which the system took the beginning.
  std::atomic_flag sending_ = ATOMIC_FLAG_INIT;
  std::array<char, kMostMessage + 4> rest_{};
  std::size_t rest_size_ = 0;
};

}  // namespace tactum::inline v0_1
