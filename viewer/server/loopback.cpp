#include "viewer/server/loopback.h"

namespace tactum {

namespace asio = boost::asio;
using tcp = asio::ip::tcp;
using boost::system::error_code;

error_code LoopbackListener::listen(int port, Serve serve) {
  serve_ = std::move(serve);
  const tcp::endpoint here(asio::ip::address_v4::loopback(), static_cast<unsigned short>(port));
  error_code error;
  acceptor_.open(here.protocol(), error);
  if (!error) acceptor_.set_option(asio::socket_base::reuse_address(true), error);
  if (!error) acceptor_.bind(here, error);
  if (!error) acceptor_.listen(asio::socket_base::max_listen_connections, error);
  if (error) return error;
  port_ = acceptor_.local_endpoint().port();
  accept();
  return {};
}

void LoopbackListener::accept() {
  acceptor_.async_accept([this](error_code error, tcp::socket socket) {
    if (error == asio::error::operation_aborted) return;
    if (!error) {
      error_code ignored;
      socket.set_option(tcp::no_delay(true), ignored);
      serve_(std::move(socket));
    }
    accept();
  });
}

}  // namespace tactum
