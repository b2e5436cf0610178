#pragma once
/// The Inverse3 and Minverse of Haply, with a VerseGrip where there is one, through the maker's service
/// (haply_messages.h), which answers each message over a WebSocket with one of its own. A thread of ours
/// sends the newest command 1000 times a second and takes the answer (loop_exchange.h):
///
///   connect   the service's version, its list of devices        nothing is commanded
///   open      origin, axes and filters set and read back, then our thread, with a force of zero
///   close     zero, our thread ended, goodbye
///
/// A command holds for one tick: a service that hears nothing lets the handle go. It puts filters between a
/// command and the motors, some of which nobody can switch off; what it says it sends to them is
/// F_D_delivered, and trouble() tells when that was another force than the one commanded.
///
/// Its axes, x right, y forward, z up, become (x, y, z)_D = (-y, x, z). It exerts no torque. Without a grip
/// the handle does not turn. With one, which tells an orientation about fifty times a second, what lies
/// between its readings and the speed of turning are made here (turn_rate.h).

#include <atomic>
#include <memory>
#include <string>
#include <thread>

#include "tactum/drivers/haply_messages.h"
#include "tactum/drivers/loop_exchange.h"
#include "tactum/drivers/survey.h"
#include "tactum/drivers/turn_rate.h"
#include "tactum/drivers/web_socket.h"

namespace tactum::inline v0_1 {

struct HaplyOptions {
  std::string host = "localhost";        ///< of the service
  int port = 10001;                      ///< of its WebSocket, and, in most versions, of its HTTP
  int other_http_port = 10000;           ///< asked for the version when `port` does not tell it
  std::string id{};                      ///< of the device: "049D"; empty: the first
  double stale_after_s = kStaleAfter_s;  ///< [s]
  double period_s = 0.001;               ///< of our thread [s]
};

/// "HOST:PORT", "ID" or "HOST:PORT/ID", as behind "haply:". Where no place is named the variable of the
/// environment TACTUM_HAPLY_SERVICE holds it, as HOST:PORT.
Result<HaplyOptions> haply_options(const std::string& argument);

class HaplyDevice final : public Device {
 public:
  /// No message tells the limits: the force beyond which the maker's plug-ins send none, and a wall softer
  /// than that of its examples (1000 N/m) [N], [N/m].
  static constexpr double kMostForce_N = 5.0, kStiffness_N_per_m = 800.0;
  static constexpr double kDelay_s = 0.002;  ///< our tick and one of the service: assumed, not measured [s]
  /// Another force than was commanded is told when it lasts for so many ticks ...
  static constexpr int kOtherForTicks = 100;
  /// ... and differs by more than this, and by more than this fraction [N].
  static constexpr double kOtherBy_N = 0.1, kOtherByFraction = 0.05;

  static Result<std::unique_ptr<Device>> connect(const HaplyOptions& options);
  static DriverSurvey survey();
  ~HaplyDevice() override { close(); }

  Result<void> open() override;
  void close() noexcept override;
  const DeviceInfo& info() const noexcept override { return info_; }
  bool read(double now_s, DeviceSample& sample) noexcept override;
  bool write(const Wrench& F_D) noexcept override;
  std::string trouble() const override;

 private:
  explicit HaplyDevice(HaplyOptions options) : options_(std::move(options)) {}
  Result<void> connect_once();
  void ask_version();
  void report_abilities();
  Result<void> configure();
  Result<void> start();
  bool ask(const std::string& message, std::string& answer);
  void run() noexcept;
  bool tick() noexcept;
  void put_into(DeviceSample& sample, const HaplyDeviceState& state) noexcept;
  void look_at_delivered(const Vec3& sent) noexcept;
  std::string place() const { return options_.host + ":" + std::to_string(options_.port); }

  HaplyOptions options_;
  std::string version_;  // of the service; empty: it does not tell
  int version_port_ = 0;
  bool as_vector_ = true;  // how it takes a force
  HaplyDeviceConfig device_;
  bool is_open_ = false;
  DeviceInfo info_;
  LoopExchange exchange_;
  std::thread thread_;
  std::atomic<bool> ends_{false};
  // On our thread.
  WebSocket socket_;
  std::string answer_;
  HaplyDeviceState state_;
  TurnRate turn_rate_;
  TurnFill turn_fill_;
  Mat3 R_DH_ = Mat3::Identity();  // what the grip told last
  Vec3 sent_before_ = Vec3::Zero();
  int other_ticks_ = 0;
  // What the service said last.
  std::atomic<bool> calibrated_{true}, ready_{true}, powered_{true}, grip_reports_{true}, answers_{true};
  // The first lasting difference since it was opened: what was sent and what was delivered [N].
  std::atomic<bool> other_force_{false};
  std::atomic<double> other_sent_N_{0.0}, other_delivered_N_{0.0};
};

}  // namespace tactum::inline v0_1
