#pragma once
/// A UDP socket that listens at one address and answers one peer; and how a socket, of UDP or TCP, comes to
/// listen at an address.

#include <netinet/in.h>

#include <cstddef>
#include <string>

#include "tactum/base/result.h"

namespace tactum::inline v0_1 {

/// Binds a socket to an IPv4 address of this machine and a port, and, where `backlog` connections may wait,
/// listens there. The error begins with `what`, and says when another program has the port; a socket that
/// could not be made, -1, is an error with errno's reason.
Result<void> listen_at(int socket, const std::string& address, int port, int backlog,
                       const std::string& what);

class DatagramSocket {
 public:
  DatagramSocket() = default;
  ~DatagramSocket() { close(); }
  DatagramSocket(const DatagramSocket&) = delete;
  DatagramSocket& operator=(const DatagramSocket&) = delete;

  /// Listens at an IPv4 address of this machine. The error says when another program has the port.
  Result<void> listen(const std::string& address, int port);
  void close() noexcept;
  bool is_listening() const noexcept { return socket_ >= 0; }

  /// Takes one datagram, without waiting, of the peer or, while there is none, of anybody; its size, which
  /// may be more than there was room for, or -1 when none is there. Others' are passed over.
  long receive(void* bytes, std::size_t room) noexcept;
  /// What can be waited for with poll; -1 when it is closed.
  int number() const noexcept { return socket_; }
  /// Makes whoever sent the last datagram the peer.
  void answer_last() noexcept;
  /// Sends to the peer, without waiting; what cannot be sent now is lost. From any thread.
  void send(const void* bytes, std::size_t size) const noexcept;

 private:
  int socket_ = -1;
  bool has_peer_ = false;
  sockaddr_in peer_{}, last_{};
};

}  // namespace tactum::inline v0_1
