#include "tactum/drivers/tcp_stream.h"

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

namespace tactum::inline v0_1 {
namespace {

constexpr std::size_t kMostAnswer = 65536;  // of http_get [bytes]

bool tcp_ready(int socket, short event, int timeout_ms) noexcept {
  pollfd waiting{socket, event, 0};
  return ::poll(&waiting, 1, timeout_ms) > 0;
}

/// A socket that is connected to the address, or -1, with errno set.
int tcp_connected(const addrinfo& address, int timeout_ms) noexcept {
  const int socket =
      ::socket(address.ai_family, address.ai_socktype | SOCK_CLOEXEC | SOCK_NONBLOCK, address.ai_protocol);
  if (socket < 0) return -1;
  int refused = ::connect(socket, address.ai_addr, address.ai_addrlen) == 0 ? 0 : errno;
  if (refused == EINPROGRESS) {
    refused = ETIMEDOUT;
    socklen_t size = sizeof refused;
    if (tcp_ready(socket, POLLOUT, timeout_ms)) ::getsockopt(socket, SOL_SOCKET, SO_ERROR, &refused, &size);
  }
  if (refused == 0) {
    const int on = 1;
    ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    return socket;
  }
  ::close(socket);
  errno = refused;
  return -1;
}

}  // namespace

Result<void> TcpStream::connect(const std::string& host, int port, int timeout_ms) {
  close();
  const std::string place = host + ":" + std::to_string(port);
  addrinfo wanted{};
  wanted.ai_family = AF_UNSPEC;
  wanted.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int failed = ::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &wanted, &found);
      failed != 0)
    return Error{"this host has no address", ::gai_strerror(failed), "a name or an address", place};
  int refused = 0;
  for (const addrinfo* address = found; address != nullptr && socket_ < 0; address = address->ai_next) {
    socket_ = tcp_connected(*address, timeout_ms);
    if (socket_ < 0) refused = errno;
  }
  ::freeaddrinfo(found);
  if (socket_ >= 0) return {};
  return Error{"nothing answers", std::strerror(refused), "", place};
}

void TcpStream::close() noexcept {
  if (socket_ >= 0) ::close(socket_);
  socket_ = -1;
}

bool TcpStream::send(std::string_view bytes, int timeout_ms) noexcept {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent > 0) {
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    } else if (sent < 0 && errno == EAGAIN) {
      if (!tcp_ready(socket_, POLLOUT, timeout_ms)) return false;
    } else if (sent == 0 || errno != EINTR) {
      return false;
    }
  }
  return true;
}

long TcpStream::receive(char* bytes, std::size_t room, int timeout_ms) noexcept {
  if (socket_ < 0) return -1;
  if (!tcp_ready(socket_, POLLIN, timeout_ms)) return 0;
  const ssize_t came = ::recv(socket_, bytes, room, MSG_DONTWAIT);
  if (came > 0) return came;
  return came < 0 && (errno == EAGAIN || errno == EINTR) ? 0 : -1;
}

Result<std::string> http_get(const std::string& host, int port, const std::string& path, int timeout_ms) {
  const std::string place = "http://" + host + ":" + std::to_string(port) + path;
  TcpStream stream;
  if (Result<void> connected = stream.connect(host, port, timeout_ms); !connected) return connected.error();
  // Version 1.0: the server then ends its answer by closing, and sends no pieces.
  if (!stream.send("GET " + path + " HTTP/1.0\r\nHost: " + host + "\r\n\r\n", timeout_ms))
    return Error{"the request cannot be sent", "a connection that broke", "", place};
  std::string answer;
  std::array<char, 4096> bytes{};
  while (answer.size() < kMostAnswer) {
    const long came = stream.receive(bytes.data(), bytes.size(), timeout_ms);
    if (came == 0)
      return Error{"the answer does not end", std::to_string(answer.size()) + " bytes", "", place};
    if (came < 0) break;
    answer.append(bytes.data(), static_cast<std::size_t>(came));
  }
  const std::size_t end = answer.find("\r\n\r\n");
  const std::string first = answer.substr(0, answer.find("\r\n"));
  if (!first.starts_with("HTTP/1.") || first.find(" 200") == std::string::npos || end == std::string::npos)
    return Error{"the server has no such answer", "'" + first.substr(0, 60) + "'", "200", place};
  return answer.substr(end + 4);
}

}  // namespace tactum::inline v0_1
