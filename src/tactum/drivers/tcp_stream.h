#pragma once
/// A TCP connection to a host, with a limit for every wait.

#include <cstddef>
#include <string>
#include <string_view>

#include "tactum/base/result.h"

namespace tactum::inline v0_1 {

class TcpStream {
 public:
  TcpStream() = default;
  ~TcpStream() { close(); }
  TcpStream(const TcpStream&) = delete;
  TcpStream& operator=(const TcpStream&) = delete;

  /// Connects, without Nagle's delay, since small messages are answered one by one. Looks the name up, which
  /// may take as long as the resolver lets it; waits for the answer of an address at most `timeout_ms`.
  Result<void> connect(const std::string& host, int port, int timeout_ms);
  void close() noexcept;
  bool is_open() const noexcept { return socket_ >= 0; }

  /// Sends all of it; false when it cannot be sent within `timeout_ms`, or the connection broke.
  bool send(std::string_view bytes, int timeout_ms) noexcept;
  /// Takes what has come, after waiting at most `timeout_ms` for the first byte: how many bytes, 0 when none
  /// came in time, -1 when the other end is gone.
  long receive(char* bytes, std::size_t room, int timeout_ms) noexcept;

 private:
  int socket_ = -1;
};

/// The body of what a server answers to GET, over a connection of its own; an error for any other answer than
/// 200. `timeout_ms` bounds each wait, and the answer may have at most 64 KiB.
Result<std::string> http_get(const std::string& host, int port, const std::string& path, int timeout_ms);

}  // namespace tactum::inline v0_1
