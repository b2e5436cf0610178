#pragma once
/// The WebSocket of one client of a bridge: who may connect, what waits for a slow client, and the speaker
/// of its protocol.

#include <boost/asio/ip/tcp.hpp>
#include <map>
#include <memory>
#include <string_view>

#include "viewer/server/bridge_speaker.h"

namespace tactum {

class BridgeConnection;

/// Everything but inbox and clients_now belongs to the bridge's thread.
struct BridgeHub {
  explicit BridgeHub(BridgeTopics shown) : topics(std::move(shown)) {}
  BridgeTopics topics;
  RequestInbox inbox;
  bool led = false;  ///< clients may lead the hand
  int connections = 0;
  std::map<std::uint64_t, BridgeConnection*> clients;  ///< by their number, which is never used twice
  std::uint64_t next_client = 1;
  std::atomic<int> clients_now{0};

  boost::asio::io_context io{1};  // last: what it still holds when it ends refers to the rest
};

/// Whether a client with this Origin may connect: programs, which state none; pages of this machine; and
/// the application of Foxglove. Any other page that a browser shows is kept out.
bool bridge_origin(std::string_view origin);

/// Serves a client of the protocol that connected to this port.
void serve_bridge(BridgeHub& hub, BridgeProtocol protocol, int port, boost::asio::ip::tcp::socket&& socket);

/// Tells every client.
void show_to_clients(BridgeHub& hub, BridgeMoment& moment);

}  // namespace tactum
