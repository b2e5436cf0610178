#pragma once
/// A device in another process or on another machine, which speaks the protocol of tactum_device.h, over UDP
/// or WebSocket, and says hello to us:
///
///   device  STATE at its own rate  -->   read: the newest, with the time it was measured
///           <--  COMMAND                 write, in each frame
///
/// Datagrams are lost, late and out of order: one that is older than the last is dropped. Over WebSocket
/// none is lost, and a delay on the way holds up all that follow: the same is done with it. When no state
/// comes for kSilent_s the sample is not valid, so the safety stage leads the wrench to zero; when none comes
/// for kDead_s writes are refused, and the loop ends as for a device that was unplugged. The device itself
/// exerts nothing when no command comes (tactum_device.h).
///
/// The delay of the way is measured before the device is opened, with commands of zero, and is part of
/// `handle.delay_s`: the gains know it. Growing much longer later is told by trouble().
///
/// The device's clock is not ours: a state is dated by its own clock, and the least difference between the
/// two clocks that was seen lately, so jitter of the way does not reach the time stamps.

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "tactum/devices/device.h"
#include "tactum/drivers/command_guard.h"
#include "tactum/drivers/network_link.h"
#include "tactum/drivers/survey.h"

struct tactum_wire_state;

namespace tactum::inline v0_1 {

struct NetworkDeviceOptions {
  std::string address = "127.0.0.1";     ///< of ours, at which devices say hello; "0.0.0.0": of every network
  int port = 0;                          ///< of ours
  double wait_for_hello_s = 10.0;        ///< [s]
  double stale_after_s = kStaleAfter_s;  ///< [s]
};

/// "PORT" or "ADDRESS:PORT", as behind "network:". Where nothing stands there the variable of the environment
/// TACTUM_NETWORK_DEVICE holds it, else the protocol's own port of 127.0.0.1 is taken.
Result<NetworkDeviceOptions> network_device_options(const std::string& argument);

class NetworkDevice final : public Device {
 public:
  static constexpr double kSilent_s = 0.020;        ///< [s]
  static constexpr double kDead_s = 0.500;          ///< [s]
  static constexpr double kMostForce_N = 40.0;      ///< whatever the device says [N]
  static constexpr double kMostTorque_Nm = 4.0;     ///< [N m]
  static constexpr double kLongestDelay_s = 0.050;  ///< beyond, no coupling is worth feeling [s]

  static Result<std::unique_ptr<Device>> connect(const NetworkDeviceOptions& options);
  static DriverSurvey survey();
  ~NetworkDevice() override { close(); }

  Result<void> open() override;
  void close() noexcept override;
  const DeviceInfo& info() const noexcept override { return info_; }
  bool read(double now_s, DeviceSample& sample) noexcept override;
  bool write(const Wrench& F_D) noexcept override;
  std::string trouble() const override;

 private:
  explicit NetworkDevice(NetworkDeviceOptions options) : options_(std::move(options)) {}
  Result<void> connect_once();
  Result<void> wait_for_hello(double until_s);
  Result<void> take_hello(const std::vector<unsigned char>& datagram);
  Result<void> measure_delay();
  bool drain(double now_s) noexcept;
  void take_state(const tactum_wire_state& state, double now_s) noexcept;
  void measure_round_trip(const tactum_wire_state& state) noexcept;
  double silence_s() noexcept;
  double dated(double device_s, double now_s) noexcept;
  void send(const Wrench& F_D) noexcept;
  void rest() noexcept;
  void say(int kind) noexcept;

  NetworkDeviceOptions options_;
  NetworkLink link_;
  DeviceInfo info_;
  CommandGate gate_;
  StaleGuard guard_;
  bool is_open_ = false;
  std::uint32_t session_ = 0;
  std::uint32_t last_state_ = 0;  // its sequence
  std::atomic<std::uint32_t> commands_{0};
  std::atomic<bool> gone_{false};  // it said goodbye, or nothing came for kDead_s
  // When the last commands were sent, by sequence: for the delay of their answers.
  static constexpr std::size_t kRemembered = 1024;
  std::array<std::atomic<double>, kRemembered> sent_s_{};
  double round_trip_s_ = 0.0;         // longest of the last second
  double round_trip_before_s_ = 0.0;  // and of the second before
  double round_trip_from_s_ = 0.0;
  std::uint32_t last_answered_ = 0;
  // Least difference of the loop's clock and the device's, of this second and the last.
  double offset_s_ = 0.0, offset_before_s_ = 0.0, offset_from_s_ = 0.0;
  bool has_offset_ = false;
  std::atomic<double> heard_s_{0.0};  // when the last state came, on the steady clock
  DeviceSample newest_;
};

}  // namespace tactum::inline v0_1
