#include "tactum/drivers/web_socket.h"

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <functional>
#include <thread>

#include "tactum/drivers/web_socket_protocol.h"

namespace tactum::web_socket_test {

/// A server of bytes: what is written is what the client gets, protocol or not.
class ByteServer {
 public:
  explicit ByteServer(std::function<void(ByteServer&)> serves) {
    listener_ = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    ::bind(listener_, reinterpret_cast<sockaddr*>(&address), sizeof address);
    ::listen(listener_, 1);
    socklen_t size = sizeof address;
    ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this, serves] {
      client_ = ::accept(listener_, nullptr, nullptr);
      serves(*this);
      ::close(client_);
    });
  }
  ~ByteServer() {
    ::shutdown(listener_, SHUT_RDWR);
    thread_.join();
    ::close(listener_);
  }
  int port() const { return port_; }
  void write(const std::string& bytes) { ::send(client_, bytes.data(), bytes.size(), MSG_NOSIGNAL); }
  /// What comes next, to its last `ending`; empty at the end.
  std::string read_to(const std::string& ending) {
    std::string text;
    while (!text.ends_with(ending)) {
      char c = 0;
      if (::recv(client_, &c, 1, 0) != 1) return "";
      text += c;
    }
    return text;
  }
  std::string read(std::size_t size) {
    std::string text(size, '\0');
    return ::recv(client_, text.data(), size, MSG_WAITALL) == static_cast<ssize_t>(size) ? text : "";
  }
  void greet() {
    const std::string head = read_to("\r\n\r\n");
    const std::string name = "Sec-WebSocket-Key: ";
    const std::size_t at = head.find(name) + name.size();
    write(
        "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: "
        "Upgrade\r\nsec-websocket-accept:" +
        web_socket_accept(head.substr(at, head.find('\r', at) - at)) + "\r\n\r\n");
  }
  /// A frame of the client's, its mask taken off: kind and text; for texts shorter than 126.
  std::pair<int, std::string> frame() {
    const std::string head = read(6);
    if (head.empty() || (head[1] & 0x80) == 0) return {-1, ""};
    std::string text = read(static_cast<std::size_t>(head[1] & 0x7f));
    for (std::size_t i = 0; i < text.size(); ++i) text[i] = static_cast<char>(text[i] ^ head[2 + i % 4]);
    return {head[0] & 0x0f, text};
  }

 private:
  int listener_ = -1, client_ = -1, port_ = 0;
  std::thread thread_;
};

constexpr int kPatient_ms = 60000, kImpatient_ms = 20;

/// What comes of bytes that follow the greeting.
WebSocket::Came after(const std::string& bytes, std::string& text) {
  ByteServer server([&bytes](ByteServer& self) {
    self.greet();
    self.write(bytes);
  });
  WebSocket socket;
  const Result<void> connected = socket.connect("127.0.0.1", server.port(), kPatient_ms);
  EXPECT_TRUE(connected) << connected.error().message();
  return socket.receive_text(text, kPatient_ms);
}

TEST(WebSocketThread, TheKeysAnswerIsThatOfTheStandard) {
  EXPECT_EQ(web_socket_accept("dGhlIHNhbXBsZSBub25jZQ=="), "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=");  // RFC 6455, 1.3
}

TEST(WebSocketThread, AMessageComesInPiecesWithAPingBetweenThem) {
  std::pair<int, std::string> pong, sent;
  {
    ByteServer server([&](ByteServer& self) {
      self.greet();
      self.write("\x01\x03one");
      self.write("\x89\x02hi");
      pong = self.frame();
      self.write(std::string("\x00\x04 two", 6));
      self.write("\x80\x06 three");
      sent = self.frame();
    });
    WebSocket socket;
    ASSERT_TRUE(socket.connect("127.0.0.1", server.port(), kPatient_ms));
    std::string text;
    EXPECT_EQ(socket.receive_text(text, kPatient_ms), WebSocket::Came::kMessage);
    EXPECT_EQ(text, "one two three");
    EXPECT_TRUE(socket.send_text("ours", kPatient_ms));
    EXPECT_EQ(socket.receive_text(text, kPatient_ms), WebSocket::Came::kEnd) << "it has hung up";
  }
  EXPECT_EQ(pong, std::make_pair(10, std::string("hi")));
  EXPECT_EQ(sent, std::make_pair(1, std::string("ours")));
}

TEST(WebSocketThread, LongMessagesHaveLongLengths) {
  const std::string some(300, 's'), many(70000, 'm');
  std::string text;
  EXPECT_EQ(after(std::string("\x81\x7e\x01\x2c", 4) + some, text), WebSocket::Came::kMessage);
  EXPECT_EQ(text, some);
  EXPECT_EQ(after(std::string("\x81\x7f\0\0\0\0\0\x01\x11\x70", 10) + many, text), WebSocket::Came::kMessage);
  EXPECT_EQ(text, many);
}

TEST(WebSocketThread, WhatBreaksTheProtocolEndsIt) {
  std::string text;
  EXPECT_EQ(after("\x88\x02\x03\xe8", text), WebSocket::Came::kEnd) << "goodbye";
  EXPECT_EQ(after(std::string("\x81\x81\0\0\0\0x", 7), text), WebSocket::Came::kEnd) << "servers do not mask";
  EXPECT_EQ(after("\xc1\x01x", text), WebSocket::Came::kEnd) << "a bit of no extension that we know";
  EXPECT_EQ(after("\x80\x01x", text), WebSocket::Came::kEnd) << "goes on with nothing";
  EXPECT_EQ(after("\x82\x01x", text), WebSocket::Came::kEnd) << "binary";
  EXPECT_EQ(after("\x01\x01x\x81\x01y", text), WebSocket::Came::kEnd) << "a new message within another";
  EXPECT_EQ(after(std::string("\x81\x7f\x7f\xff\xff\xff\xff\xff\xff\xff", 10), text), WebSocket::Came::kEnd)
      << "longer than any memory";
  EXPECT_EQ(after(std::string("\x89\x7e\x01\x00", 4) + std::string(256, 'p'), text), WebSocket::Came::kEnd)
      << "a ping that is too long";
}

TEST(WebSocketThread, OneThatIsSilentIsWaitedForNoLongerThanAsked) {
  std::atomic<bool> done{false};
  ByteServer server([&done](ByteServer& self) {
    self.greet();
    self.write("\x81");  // half of a head
    while (!done) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  });
  WebSocket socket;
  EXPECT_TRUE(socket.connect("127.0.0.1", server.port(), kPatient_ms));
  std::string text;
  EXPECT_EQ(socket.receive_text(text, kImpatient_ms), WebSocket::Came::kNothing);
  done = true;
}

TEST(WebSocketThread, WhatDoesNotSpeakItIsRefused) {
  for (const char* answer : {"HTTP/1.1 404 Not Found\r\n\r\n", "SSH-2.0-x\r\n\r\n",
                             "HTTP/1.1 101 Switching Protocols\r\nSec-WebSocket-Accept: wrong\r\n\r\n",
                             "HTTP/1.1 101 Switching Protocols\r\n\r\n"}) {
    ByteServer server([answer](ByteServer& self) {
      self.read_to("\r\n\r\n");
      self.write(answer);
    });
    WebSocket socket;
    const Result<void> connected = socket.connect("127.0.0.1", server.port(), kPatient_ms);
    ASSERT_FALSE(connected) << answer;
    EXPECT_NE(connected.error().message().find("does not speak"), std::string::npos);
    EXPECT_FALSE(socket.is_open());
  }
}

TEST(WebSocketThread, AnHttpAnswerIsItsBody) {
  const auto get = [](const char* answer) {
    ByteServer server([answer](ByteServer& self) {
      EXPECT_TRUE(self.read_to("\r\n\r\n").starts_with("GET /version HTTP/1.0\r\n"));
      self.write(answer);
    });
    return http_get("127.0.0.1", server.port(), "/version", kPatient_ms);
  };
  const Result<std::string> found = get("HTTP/1.0 200 OK\r\nContent-Length: 2\r\n\r\n{}");
  ASSERT_TRUE(found) << found.error().message();
  EXPECT_EQ(*found, "{}");
  EXPECT_FALSE(get("HTTP/1.0 500 Sorry\r\n\r\n{}"));
  EXPECT_FALSE(get("nonsense"));
  const Result<std::string> nobody = http_get("127.0.0.1", 1, "/version", kPatient_ms);
  ASSERT_FALSE(nobody);
  EXPECT_NE(nobody.error().message().find("refused"), std::string::npos) << nobody.error().message();
}

}  // namespace tactum::web_socket_test
