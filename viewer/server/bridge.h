#pragma once
/// A run told to programs of robotics (docs/bridges.md): WebSockets on the loopback interface that speak
/// rosbridge and Foxglove's protocol, all on one thread of their own.
///
///   owner's thread: show_frame, show_picture, send ---posted---> bridge's thread <---> clients
///                   take                           <---inbox----
///
/// Neither the loop nor the owner waits for a client: messages that a slow one does not take give way to
/// newer ones, oldest first, and it is told how many did.

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "tactum/base/result.h"
#include "viewer/server/bridge_topics.h"
#include "viewer/server/request.h"

namespace tactum {

/// A bridge that is asked for.
struct BridgeChoice {
  BridgeProtocol protocol = BridgeProtocol::kRosbridge;
  int port = 0;  ///< 0: one that is free
};

/// "rosbridge", "foxglove:8765"; without a port the protocol's usual one, 9090 or 8765.
Result<BridgeChoice> parse_bridge(const std::string& text);

class Bridge {
 public:
  /// Listens on 127.0.0.1. Clients may lead the hand where `led`. An error gives the reason.
  static Result<std::unique_ptr<Bridge>> start(const std::vector<BridgeChoice>& choices, BridgeTopics topics,
                                               bool led);
  ~Bridge();
  Bridge(const Bridge&) = delete;
  Bridge& operator=(const Bridge&) = delete;

  /// A sentence for each bridge, with its address.
  const std::vector<std::string>& sentences() const noexcept;
  /// Its ports, in the order of the choices.
  const std::vector<int>& ports() const noexcept;
  /// Clients that are connected now.
  int clients() const noexcept;

  /// Frames and pictures that are over; kept until send(), which passes them to the bridge's thread.
  void show_frame(BridgeFrame frame);
  void show_picture(const FramePicture& picture, std::uint64_t time_ns);
  void send();
  /// The next request of a client, kAim or kRest; false when there is none.
  bool take(Request& request);

 private:
  struct Impl;
  explicit Bridge(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace tactum
