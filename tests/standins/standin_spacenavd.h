#pragma once
/// A stand-in for spacenavd: a server of its own on a Unix socket, that speaks version 0 or 1 of the
/// protocol to one client after the other, and what no daemon says where a test wants it to.

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <thread>

namespace tactum::standin {

class Spacenavd {
 public:
  explicit Spacenavd(int protocol) : protocol_(protocol) {
    std::string folder = (std::filesystem::temp_directory_path() / "tactum-spacenavd-XXXXXX").string();
    if (mkdtemp(folder.data()) != nullptr) folder_ = folder;
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, path().c_str(), sizeof address.sun_path - 1);
    listener_ = ::socket(AF_UNIX, SOCK_STREAM, 0);
    if (::bind(listener_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0)
      ::listen(listener_, 4);
    thread_ = std::thread([this] { serve(); });
  }
  ~Spacenavd() {
    ::shutdown(listener_, SHUT_RDWR);  // accept returns
    thread_.join();
    ::close(listener_);
    hang_up();
    ::unlink(path().c_str());
    ::rmdir(folder_.c_str());
  }
  Spacenavd(const Spacenavd&) = delete;
  Spacenavd& operator=(const Spacenavd&) = delete;

  std::string path() const { return folder_ + "/spnav.sock"; }
  /// Whether a client has been greeted, and is still there.
  bool has_client() const { return client_ >= 0; }
  /// What an old daemon was sent as sensitivity, what a new one as event mask.
  float sensitivity() const { return sensitivity_; }
  std::int32_t event_mask() const { return event_mask_; }

  bool send(const void* bytes, std::size_t size) {
    return ::send(client_, bytes, size, MSG_NOSIGNAL) == static_cast<ssize_t>(size);
  }
  bool send_message(const std::array<std::int32_t, 8>& message) {
    return send(message.data(), sizeof message);
  }
  bool send_motion(int x, int y, int z, int rx, int ry, int rz) {
    return send_message({0, x, y, z, rx, ry, rz, 16});
  }
  bool send_button(int number, bool pressed) { return send_message({pressed ? 1 : 2, number, pressed}); }
  void hang_up() {
    const int client = client_.exchange(-1);
    if (client >= 0) ::close(client);
  }

 private:
  static bool take(int client, void* bytes, std::size_t size) {
    return ::recv(client, bytes, size, MSG_WAITALL) == static_cast<ssize_t>(size);
  }
  bool greet(int client) {
    constexpr std::int32_t kTag = 0x7faa5500;
    std::int32_t hello = 0;
    if (!take(client, &hello, sizeof hello) || hello != (kTag | 1)) return false;
    if (protocol_ == 0) {  // it takes the greeting for a sensitivity that is not a number, and ignores it
      float sensitivity = 0.0f;
      const bool took = take(client, &sensitivity, sizeof sensitivity);
      sensitivity_ = sensitivity;
      return took;
    }
    const std::int32_t answer = kTag | protocol_;
    std::array<std::int32_t, 8> request{};
    if (::send(client, &answer, sizeof answer, MSG_NOSIGNAL) < 0 ||
        !take(client, request.data(), sizeof request))
      return false;
    constexpr std::int32_t kSetEventMask = 0x1003;
    if (request[0] == kSetEventMask) event_mask_ = request[1];
    return request[0] == kSetEventMask;
  }
  void serve() {
    for (int client; (client = ::accept(listener_, nullptr, nullptr)) >= 0;) {
      hang_up();
      if (greet(client))
        client_ = client;
      else
        ::close(client);
    }
  }

  int protocol_;
  std::string folder_;
  int listener_ = -1;
  std::atomic<int> client_{-1};
  std::atomic<float> sensitivity_{0.0f};
  std::atomic<std::int32_t> event_mask_{0};
  std::thread thread_;
};

}  // namespace tactum::standin
