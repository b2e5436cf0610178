#pragma once
/// A client of WebSockets by Boost.Beast, which shares no code with the driver, for binary messages.

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace tactum {

class WebPeer {
 public:
  WebPeer();
  ~WebPeer();
  WebPeer(const WebPeer&) = delete;
  WebPeer& operator=(const WebPeer&) = delete;

  /// False when nobody listens at this port of the machine, or we are not let in. `origin`: the page that a
  /// browser would name.
  bool connect(int port, const std::string& origin = "");
  bool is_open() const;
  /// A message in one frame, or in several of at most `piece` bytes.
  void send(const std::vector<unsigned char>& bytes, std::size_t piece = 0);
  void send_text(const std::string& text);
  void ping(const std::string& text);
  int pongs() const;
  /// Bytes past the protocol.
  void send_raw(const std::string& bytes);
  /// The next message; nothing when none is there. Does not wait.
  std::optional<std::vector<unsigned char>> take();
  /// Without a goodbye.
  void close();

 private:
  struct Connection;
  std::unique_ptr<Connection> connection_;
};

/// A port of this machine at which neither UDP nor TCP is in use.
int free_network_port();

}  // namespace tactum
