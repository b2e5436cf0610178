#pragma once
/// What the viewer's server and the bridges share of their sockets: a port of the loopback interface that is
/// listened to, and the limits of a WebSocket.

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/websocket.hpp>
#include <functional>

#include "viewer/server/connection_hub.h"

namespace tactum {

/// A port of 127.0.0.1. It is destroyed before what it serves, and after its io_context was stopped.
class LoopbackListener {
 public:
  using Serve = std::function<void(boost::asio::ip::tcp::socket&&)>;
  explicit LoopbackListener(boost::asio::io_context& io) : acceptor_(io) {}

  /// Serves every client of this port, 0 for one that is free, on the thread that runs the io_context. An
  /// error says why it cannot be listened to.
  boost::system::error_code listen(int port, Serve serve);
  int port() const noexcept { return port_; }

 private:
  void accept();
  boost::asio::ip::tcp::acceptor acceptor_;
  int port_ = 0;
  Serve serve_;
};

/// A client that neither sends nor takes anything for kClientTimeout is closed; so is one that sends a longer
/// message than this [bytes].
template <class Stream>
void set_limits(boost::beast::websocket::stream<Stream>& socket, std::size_t largest_message) {
  boost::beast::websocket::stream_base::timeout timeout{};
  timeout.handshake_timeout = kClientTimeout;
  timeout.idle_timeout = kClientTimeout;
  timeout.keep_alive_pings = true;
  socket.set_option(timeout);
  socket.read_message_max(largest_message);
  socket.auto_fragment(false);
}

}  // namespace tactum
