#pragma once
/// A page without a browser, on bare sockets: it shares no code with the server that it talks to.

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <string>

namespace tactum::testing {

class RawConnection {
 public:
  explicit RawConnection(int port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (::connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) close();
  }
  ~RawConnection() { close(); }
  RawConnection(const RawConnection&) = delete;
  RawConnection& operator=(const RawConnection&) = delete;

  bool open() const { return socket_ >= 0; }
  void close() {
    if (socket_ >= 0) ::close(socket_);
    socket_ = -1;
  }
  void send(const std::string& bytes) {
    for (std::size_t at = 0; at < bytes.size();) {
      const ssize_t sent = ::send(socket_, bytes.data() + at, bytes.size() - at, MSG_NOSIGNAL);
      if (sent <= 0) return;
      at += static_cast<std::size_t>(sent);
    }
  }
  /// The bytes that came within `wait_ms`, appended to those left; false when the other end has closed.
  bool receive(int wait_ms) {
    pollfd waiting{socket_, POLLIN, 0};
    if (::poll(&waiting, 1, wait_ms) <= 0) return true;
    char bytes[65536];
    const ssize_t got = ::recv(socket_, bytes, sizeof bytes, 0);
    if (got <= 0) return false;
    buffer.append(bytes, static_cast<std::size_t>(got));
    return true;
  }
  std::string buffer;

 private:
  int socket_;
};

/// One request; the whole answer, until the server closes or nothing more comes.
inline std::string ask(int port, const std::string& request) {
  RawConnection connection(port);
  connection.send(request);
  for (int i = 0; i < 20 && connection.receive(i == 0 ? 3000 : 100); ++i)
    if (connection.buffer.find("\r\n\r\n") != std::string::npos && i > 0) break;
  return connection.buffer;
}

inline int status_of(const std::string& answer) {
  return answer.size() > 12 ? std::atoi(answer.c_str() + 9) : 0;
}

class RawPage : public RawConnection {
 public:
  struct Message {
    int kind = 0;  // 1 text, 2 binary, 8 close; 0: none came
    std::string payload;
  };

  RawPage(int port, const std::string& token, const std::string& origin) : RawConnection(port) {
    send("GET /" + token + "/ws HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port) +
         "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nOrigin: " + origin +
         "\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n");
    std::size_t end = std::string::npos;
    while ((end = buffer.find("\r\n\r\n")) == std::string::npos)
      if (!receive(5000) || buffer.empty()) return;
    answer = buffer.substr(0, end);
    buffer.erase(0, end + 4);
  }
  bool accepted() const { return status_of(answer) == 101; }

  void say(const std::string& text, int kind = 1) {
    std::string frame(1, static_cast<char>(0x80 | kind));
    if (text.size() < 126) {
      frame += static_cast<char>(0x80 | text.size());
    } else {
      frame += static_cast<char>(0x80 | 126);
      frame += static_cast<char>(text.size() >> 8);
      frame += static_cast<char>(text.size() & 0xff);
    }
    frame.append(4, '\0');  // a mask of zeros is a mask
    send(frame + text);
  }

  /// The next message; kind 0 when none came in time, 8 when the server has closed.
  Message next(int wait_ms) {
    for (;;) {
      Message message;
      if (take(message)) return message;
      const std::size_t before = buffer.size();
      if (!receive(wait_ms)) return {8, ""};
      if (buffer.size() == before) return {};
    }
  }

  std::string answer;  // to the request to become a WebSocket

 private:
  bool take(Message& message) {
    if (buffer.size() < 2) return false;
    const auto byte = [this](std::size_t i) {
      return static_cast<std::uint64_t>(static_cast<unsigned char>(buffer[i]));
    };
    std::uint64_t length = byte(1) & 0x7f;
    std::size_t head = 2;
    if (length >= 126) {
      const std::size_t wide = length == 126 ? 2 : 8;
      if (buffer.size() < 2 + wide) return false;
      length = 0;
      for (std::size_t i = 0; i < wide; ++i) length = length << 8 | byte(2 + i);
      head += wide;
    }
    if (buffer.size() < head + length) return false;
    message = {static_cast<int>(byte(0) & 0x0f), buffer.substr(head, length)};
    buffer.erase(0, head + length);
    return true;
  }
};

inline std::uint32_t word_at(const std::string& bytes, std::size_t index) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.data() + 4 * index, sizeof word);
  return word;
}

}  // namespace tactum::testing
