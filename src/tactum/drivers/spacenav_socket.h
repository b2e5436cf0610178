#pragma once
/// A client of spacenavd, the free driver of the SpaceMice of 3Dconnexion, on its Unix socket. Both versions
/// of its protocol are spoken, chosen by what the daemon answers:
///
///   we: 0x7faa5501 (int32)       daemon of version 1: 0x7faa55vv, and then messages of 8 int32
///                                older: nothing; it then is sent 1.0f, the sensitivity it expects
///
/// A message is {type, 7 numbers}: motion {0, x, y, z, rx, ry, rz, milliseconds}, button {1 or 2, number};
/// what is 0x1000 or more answers a request. Axes are those of the daemon: x right, y up, z away from the
/// user, rotations about them by the left hand; deflections of -500 to 500.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "tactum/base/result.h"

namespace tactum::inline v0_1 {

/// How the cap is deflected now. It springs back by itself; the daemon is silent while nothing changes.
struct SpacenavState {
  std::array<int, 3> push{};  ///< x, y, z, of +-500
  std::array<int, 3> turn{};  ///< rx, ry, rz, of +-500
  std::uint32_t buttons = 0;  ///< bit 0 is the first button
};

/// The socket that is asked when none is named: SPNAV_SOCKET, else the one that /etc/spnavrc names, else
/// /var/run/spnav.sock.
std::string spacenav_socket_path();

class SpacenavSocket {
 public:
  SpacenavSocket() = default;
  ~SpacenavSocket() { close(); }
  SpacenavSocket(const SpacenavSocket&) = delete;
  SpacenavSocket& operator=(const SpacenavSocket&) = delete;

  /// Connects and finds the protocol out, which takes 0.3 s with an old daemon.
  Result<void> connect(const std::string& path);
  void close() noexcept;

  /// Takes what the daemon has sent, without waiting; false when it is gone, or sends what is no message
  /// (trouble() says which). The state is then that of a cap at rest.
  bool drain() noexcept;

  const SpacenavState& state() const noexcept { return state_; }
  int protocol() const noexcept { return protocol_; }  ///< 0 or 1
  const char* trouble() const noexcept { return trouble_; }

 private:
  static constexpr std::size_t kMessageBytes = 32;

  Result<void> handshake(const std::string& path);
  void drop_late_answer() noexcept;
  bool take_message(const std::array<std::int32_t, 8>& message) noexcept;
  bool lose(const char* trouble) noexcept;

  int socket_ = -1;
  int protocol_ = 0;
  SpacenavState state_;
  std::array<unsigned char, kMessageBytes> partial_{};  // a message that came in pieces
  std::size_t filled_ = 0;
  const char* trouble_ = "";
};

}  // namespace tactum::inline v0_1
