#include "tactum/drivers/network_link.h"

#include <poll.h>

namespace tactum::inline v0_1 {

Result<void> NetworkLink::listen(const std::string& address, int port) {
  close();
  Result<void> listening = datagrams_.listen(address, port);
  if (listening) listening = web_socket_.listen(address, port);
  if (!listening) close();
  return listening;
}

void NetworkLink::close() noexcept {
  datagrams_.close();
  web_socket_.close();
  peer_ = last_ = From::kNobody;
}

bool NetworkLink::wait(int timeout_ms) const noexcept {
  pollfd waiting[] = {{peer_ == From::kWebSocket ? -1 : datagrams_.number(), POLLIN, 0},
                      {web_socket_.client() >= 0 ? -1 : web_socket_.listener(), POLLIN, 0},
                      {web_socket_.client(), POLLIN, 0}};
  return ::poll(waiting, 3, timeout_ms) > 0;
}

void NetworkLink::serve() {
  if (peer_ == From::kNobody) web_socket_.serve();
}

long NetworkLink::receive(void* bytes, std::size_t room) noexcept {
  if (peer_ != From::kWebSocket) {
    last_ = From::kDatagram;
    const long size = datagrams_.receive(bytes, room);
    if (size >= 0 || peer_ == From::kDatagram) return size;
  }
  last_ = From::kWebSocket;
  return web_socket_.receive(bytes, room);
}

void NetworkLink::answer_last() noexcept {
  peer_ = last_;
  if (peer_ == From::kDatagram) {
    datagrams_.answer_last();
    web_socket_.close();
  } else {
    web_socket_.stop_listening();
  }
}

void NetworkLink::send(const void* bytes, std::size_t size) noexcept {
  if (peer_ == From::kDatagram) datagrams_.send(bytes, size);
  if (peer_ == From::kWebSocket) web_socket_.send(bytes, size);
}

}  // namespace tactum::inline v0_1
