#pragma once
/// The way to a device in another process: UDP and WebSocket at one port, until a device has said hello over
/// one of them; then that one. The packets are the same: a datagram, or a binary message, each.

#include <cstddef>
#include <string>

#include "tactum/drivers/datagram_socket.h"
#include "tactum/drivers/web_socket_link.h"

namespace tactum::inline v0_1 {

class NetworkLink {
 public:
  /// Listens over both at an IPv4 address of this machine.
  Result<void> listen(const std::string& address, int port);
  void close() noexcept;
  bool is_listening() const noexcept { return datagrams_.is_listening(); }

  /// Waits for a packet, or for something that serve() looks after; false when nothing came. A WebSocket that
  /// comes while there is another one does not end the wait.
  bool wait(int timeout_ms) const noexcept;
  /// Before there is a peer: lets WebSockets in. May allocate.
  void serve();
  /// Takes one packet, without waiting, of the peer or, while there is none, of anybody; its size, which may
  /// be more than there was room for, or -1 when none is there.
  long receive(void* bytes, std::size_t room) noexcept;
  /// Makes whoever sent the last packet the peer.
  void answer_last() noexcept;
  /// Sends to the peer, without waiting; what cannot be sent now is lost. From any thread.
  void send(const void* bytes, std::size_t size) noexcept;
  /// Throws away what a WebSocket has sent, as the system does with datagrams that nobody takes; whether
  /// there was anything. From any thread.
  bool discard() noexcept { return peer_ == From::kWebSocket && web_socket_.discard(); }
  /// The peer's connection is over; of datagrams nobody knows.
  bool has_ended() const noexcept { return peer_ == From::kWebSocket && web_socket_.has_ended(); }
  /// Why the last WebSocket that was refused was; empty when none was.
  const std::string& last_refusal() const noexcept { return web_socket_.last_refusal(); }

 private:
  enum class From { kNobody, kDatagram, kWebSocket };
  DatagramSocket datagrams_;  // stays after a WebSocket is the peer, so that the port remains ours
  WebSocketLink web_socket_;
  From peer_ = From::kNobody, last_ = From::kNobody;
};

}  // namespace tactum::inline v0_1
