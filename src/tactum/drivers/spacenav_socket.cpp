#include "tactum/drivers/spacenav_socket.h"

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>

namespace tactum::inline v0_1 {
namespace {

constexpr std::int32_t kProtocolTag = 0x7faa5500;  // with the version in the low byte
constexpr std::int32_t kTagMask = ~std::int32_t{0xff};
constexpr int kHandshake_ms = 300;
constexpr int kFullDeflection = 500;
constexpr int kMostMessagesPerDrain = 1024;  // a second's worth and more; what is left comes at the next
constexpr std::int32_t kSetEventMask = 0x1003;
constexpr std::int32_t kMotionAndButtons = 3;
constexpr std::int32_t kFirstAnswer = 0x1000, kBeyondAnswers = 0x10000;
constexpr std::int32_t kMotion = 0, kPress = 1, kRelease = 2,
                       kRawButton = 6;  // 3 to 5: device, settings, raw

bool send_all(int socket, const void* bytes, std::size_t size) noexcept {
  return ::send(socket, bytes, size, MSG_NOSIGNAL) == static_cast<ssize_t>(size);
}

bool readable_within(int socket, int timeout_ms) noexcept {
  pollfd waiting{socket, POLLIN, 0};
  return ::poll(&waiting, 1, timeout_ms) > 0;
}

}  // namespace

std::string spacenav_socket_path() {
  if (const char* named = std::getenv("SPNAV_SOCKET"); named != nullptr && *named != '\0') return named;
  std::ifstream settings("/etc/spnavrc");
  for (std::string line; std::getline(settings, line);) {
    line.erase(std::remove(line.begin(), line.end(), ' '), line.end());
    constexpr const char* kKey = "socket=";
    if (line.starts_with(kKey) && line.size() > std::strlen(kKey)) return line.substr(std::strlen(kKey));
  }
  return "/var/run/spnav.sock";
}

Result<void> SpacenavSocket::connect(const std::string& path) {
  close();
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof address.sun_path)
    return Error{"this cannot be the name of a socket", "'" + path + "'", "a short path", "SPNAV_SOCKET"};
  std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
  socket_ = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (socket_ < 0) return Error{"cannot make a socket", std::strerror(errno), "", path};
  if (::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    const int refused = errno;
    close();
    const char* cure =
        refused == EACCES
            ? "a socket that you may write to: its daemon belongs to root and gives everybody access"
            : "spacenavd running: apt install spacenavd, then systemctl start spacenavd (or name "
              "its socket in SPNAV_SOCKET)";
    return Error{"no spacenavd answers", std::strerror(refused), cure, path};
  }
  return handshake(path);
}

Result<void> SpacenavSocket::handshake(const std::string& path) {
  const std::int32_t hello = kProtocolTag | 1;
  if (!send_all(socket_, &hello, sizeof hello)) {
    close();
    return Error{"spacenavd does not listen", std::strerror(errno), "a daemon that runs", path};
  }
  std::int32_t answer = 0;
  // Peeked at: an old daemon may just now send its first motion, of which nothing must be lost.
  const bool answered =
      readable_within(socket_, kHandshake_ms) &&
      ::recv(socket_, &answer, sizeof answer, MSG_PEEK) == static_cast<ssize_t>(sizeof answer) &&
      (answer & kTagMask) == kProtocolTag;
  if (!answered) {
    const float sensitivity = 1.0f;
    protocol_ = 0;
    if (send_all(socket_, &sensitivity, sizeof sensitivity)) return {};
    close();
    return Error{"spacenavd closed the connection", "no answer", "a daemon that runs", path};
  }
  const ssize_t taken = ::recv(socket_, &answer, sizeof answer, 0);
  const std::array<std::int32_t, 8> mask{kSetEventMask, kMotionAndButtons};
  protocol_ = static_cast<int>(answer & 0xff);
  if (taken == static_cast<ssize_t>(sizeof answer) && send_all(socket_, mask.data(), sizeof mask)) return {};
  close();
  return Error{"spacenavd closed the connection", "no answer", "a daemon that runs", path};
}

void SpacenavSocket::close() noexcept {
  if (socket_ >= 0) ::close(socket_);
  socket_ = -1;
  protocol_ = 0;
  filled_ = 0;
  state_ = {};
  trouble_ = "";
}

bool SpacenavSocket::lose(const char* trouble) noexcept {
  close();
  trouble_ = trouble;
  return false;
}

bool SpacenavSocket::drain() noexcept {
  if (socket_ < 0) return false;
  for (int n = 0; n < kMostMessagesPerDrain; ++n) {
    const ssize_t came = ::recv(socket_, partial_.data() + filled_, kMessageBytes - filled_, MSG_DONTWAIT);
    if (came == 0) return lose("spacenavd closed the connection; start it again");
    if (came < 0) {
      if (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR) return true;
      return lose("the connection to spacenavd broke; start it again");
    }
    filled_ += static_cast<std::size_t>(came);
    drop_late_answer();
    if (filled_ < kMessageBytes) continue;
    filled_ = 0;
    std::array<std::int32_t, 8> message{};
    std::memcpy(message.data(), partial_.data(), kMessageBytes);
    if (!take_message(message))
      return lose("what listens at spacenavd's socket sends no messages of its protocol; see SPNAV_SOCKET");
  }
  return true;
}

/// A daemon that was sending a motion when it was greeted answers behind that.
void SpacenavSocket::drop_late_answer() noexcept {
  std::int32_t answer = 0;
  if (filled_ < sizeof answer) return;
  std::memcpy(&answer, partial_.data(), sizeof answer);
  if ((answer & kTagMask) != kProtocolTag) return;
  protocol_ = static_cast<int>(answer & 0xff);
  filled_ -= sizeof answer;
  std::memmove(partial_.data(), partial_.data() + sizeof answer, filled_);
}

/// False for what no daemon sends: the stream is then out of step, and nothing of it can be trusted.
bool SpacenavSocket::take_message(const std::array<std::int32_t, 8>& message) noexcept {
  const std::int32_t type = message[0];
  if (type < 0 || type >= kBeyondAnswers || (type > kRawButton && type < kFirstAnswer)) return false;
  if (type == kMotion) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      state_.push[axis] = std::clamp(message[1 + axis], -kFullDeflection, kFullDeflection);
      state_.turn[axis] = std::clamp(message[4 + axis], -kFullDeflection, kFullDeflection);
    }
  } else if (type == kPress || type == kRelease) {
    if (message[1] < 0 || message[1] >= 32) return true;  // more buttons than a sample has bits
    const std::uint32_t bit = 1u << static_cast<unsigned>(message[1]);
    state_.buttons = type == kPress ? state_.buttons | bit : state_.buttons & ~bit;
  }
  return true;
}

}  // namespace tactum::inline v0_1
