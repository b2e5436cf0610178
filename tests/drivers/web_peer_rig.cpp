#include "web_peer.h"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <deque>
#include <utility>

namespace tactum {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = boost::beast::websocket;
using asio::ip::tcp;

struct WebPeer::Connection {
  asio::io_context context;
  websocket::stream<tcp::socket> stream{context};
  beast::flat_buffer buffer;
  std::deque<std::vector<unsigned char>> messages;
  int pongs = 0;
  bool is_open = false;

  /// Reads message after message, whenever the context is polled.
  void read_on() {
    stream.async_read(buffer, [this](boost::system::error_code error, std::size_t) {
      if (error) {
        is_open = false;
        return;
      }
      const auto* bytes = static_cast<const unsigned char*>(buffer.data().data());
      messages.emplace_back(bytes, bytes + buffer.size());
      buffer.clear();
      read_on();
    });
  }
};

WebPeer::WebPeer() : connection_(std::make_unique<Connection>()) {}
WebPeer::~WebPeer() = default;

bool WebPeer::connect(int port, const std::string& origin) {
  connection_ = std::make_unique<Connection>();
  Connection& now = *connection_;
  boost::system::error_code error;
  now.stream.next_layer().connect({asio::ip::address_v4::loopback(), static_cast<unsigned short>(port)},
                                  error);
  if (error) return false;
  now.stream.next_layer().set_option(tcp::no_delay(true), error);
  now.stream.set_option(websocket::stream_base::decorator([&origin](websocket::request_type& request) {
    if (!origin.empty()) request.set(beast::http::field::origin, origin);
  }));
  now.stream.control_callback([&now](websocket::frame_type kind, beast::string_view) {
    if (kind == websocket::frame_type::pong) ++now.pongs;
  });
  now.stream.handshake("127.0.0.1:" + std::to_string(port), "/", error);
  now.stream.binary(true);
  now.is_open = !error;
  if (now.is_open) now.read_on();
  return now.is_open;
}

bool WebPeer::is_open() const { return connection_->is_open; }
int WebPeer::pongs() const { return connection_->pongs; }

void WebPeer::send(const std::vector<unsigned char>& bytes, std::size_t piece) {
  Connection& now = *connection_;
  if (!now.is_open) return;
  boost::system::error_code error;
  now.stream.auto_fragment(piece > 0);
  if (piece > 0) now.stream.write_buffer_bytes(piece);
  now.stream.write(asio::buffer(bytes), error);
  if (error) now.is_open = false;
}

void WebPeer::send_text(const std::string& text) {
  boost::system::error_code error;
  connection_->stream.text(true);
  connection_->stream.write(asio::buffer(text), error);
  connection_->stream.binary(true);
}

void WebPeer::ping(const std::string& text) {
  boost::system::error_code error;
  connection_->stream.ping(websocket::ping_data(text), error);
}

void WebPeer::send_raw(const std::string& bytes) {
  boost::system::error_code error;
  asio::write(connection_->stream.next_layer(), asio::buffer(bytes), error);
}

std::optional<std::vector<unsigned char>> WebPeer::take() {
  Connection& now = *connection_;
  if (now.messages.empty()) {
    now.context.restart();
    now.context.poll();
  }
  if (now.messages.empty()) return std::nullopt;
  std::vector<unsigned char> message = std::move(now.messages.front());
  now.messages.pop_front();
  return message;
}

void WebPeer::close() {
  boost::system::error_code error;
  connection_->stream.next_layer().close(error);
  connection_->is_open = false;
}

int free_network_port() {
  for (;;) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const int datagrams = ::socket(AF_INET, SOCK_DGRAM, 0), stream = ::socket(AF_INET, SOCK_STREAM, 0);
    ::bind(datagrams, reinterpret_cast<sockaddr*>(&address), sizeof address);
    socklen_t size = sizeof address;
    ::getsockname(datagrams, reinterpret_cast<sockaddr*>(&address), &size);
    const bool is_free = ::bind(stream, reinterpret_cast<sockaddr*>(&address), size) == 0;
    ::close(datagrams);
    ::close(stream);
    if (is_free) return ntohs(address.sin_port);
  }
}

}  // namespace tactum
