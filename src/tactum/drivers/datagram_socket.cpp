#include "tactum/drivers/datagram_socket.h"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace tactum::inline v0_1 {
namespace {

bool same_sender(const sockaddr_in& a, const sockaddr_in& b) noexcept {
  return a.sin_addr.s_addr == b.sin_addr.s_addr && a.sin_port == b.sin_port;
}

}  // namespace

Result<void> listen_at(int socket, const std::string& address, int port, int backlog,
                       const std::string& what) {
  const std::string place = address + ":" + std::to_string(port);
  if (socket < 0) return Error{"cannot make a socket", std::strerror(errno), "", place};
  sockaddr_in ours{};
  ours.sin_family = AF_INET;
  ours.sin_port = htons(static_cast<std::uint16_t>(port));
  if (inet_pton(AF_INET, address.c_str(), &ours.sin_addr) != 1)
    return Error{"this is no address", "'" + address + "'", "four numbers, such as 127.0.0.1", place};
  if (::bind(socket, reinterpret_cast<const sockaddr*>(&ours), sizeof ours) == 0 &&
      (backlog == 0 || ::listen(socket, backlog) == 0))
    return {};
  return Error{what, std::strerror(errno),
               errno == EADDRINUSE ? "a port that no other program has: network:PORT"
                                   : "an address of this machine: network:ADDRESS:PORT",
               place};
}

Result<void> DatagramSocket::listen(const std::string& address, int port) {
  close();
  socket_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  Result<void> listens = listen_at(socket_, address, port, 0, "cannot listen for a device");
  if (!listens) close();
  return listens;
}

void DatagramSocket::close() noexcept {
  if (socket_ >= 0) ::close(socket_);
  socket_ = -1;
  has_peer_ = false;
}

long DatagramSocket::receive(void* bytes, std::size_t room) noexcept {
  for (;;) {
    sockaddr_in from{};
    socklen_t size = sizeof from;
    const ssize_t got =
        ::recvfrom(socket_, bytes, room, MSG_DONTWAIT | MSG_TRUNC, reinterpret_cast<sockaddr*>(&from), &size);
    if (got < 0) {
      if (errno == EINTR || errno == ECONNREFUSED) continue;  // refused: of an earlier send
      return -1;
    }
    if (has_peer_ && !same_sender(from, peer_)) continue;
    last_ = from;
    return got;
  }
}

void DatagramSocket::answer_last() noexcept {
  peer_ = last_;
  has_peer_ = true;
}

void DatagramSocket::send(const void* bytes, std::size_t size) const noexcept {
  if (!has_peer_) return;
  static_cast<void>(::sendto(socket_, bytes, size, MSG_DONTWAIT | MSG_NOSIGNAL,
                             reinterpret_cast<const sockaddr*>(&peer_), sizeof peer_));
}

}  // namespace tactum::inline v0_1
