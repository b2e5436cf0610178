#pragma once
/// The Virtuose of Haption, through VirtuoseAPI 4 (virtuose_library.h). The library owns a thread, clocked by
/// the controller's packets, that calls us 1000 times a second (loop_exchange.h).
///
///   connect   load, open, ask for abilities              no motor is on
///   open      frames, impedance mode, limits, power, a zero wrench, then the library's loop
///   close     zero, the loop stopped, zero once more, force and power off, released
///
/// Its axes are those of D and its units SI. Its origin is in its base, and no function tells the middle of
/// its workspace: D's origin is where the handle is when the device is opened. The wrench is sent as float.
///
/// The motors count as off while the dead man's sensor is not held, while the emergency stop is pressed,
/// without power, and for kRelays_s after power has come, in which the relays close. Power that is lost stays
/// off until the device is opened anew. Any call that fails while the loop runs counts as a lost device.

#include <array>
#include <atomic>
#include <memory>
#include <string>

#include "tactum/drivers/loop_exchange.h"
#include "tactum/drivers/survey.h"
#include "tactum/drivers/virtuose_library.h"

namespace tactum::inline v0_1 {

/// Before its relays are closed, a motor that has power does not push; what is commanded meanwhile would come
/// as a step [s].
inline constexpr double kVirtuoseRelays_s = 3.0;

struct VirtuoseOptions {
  std::string host{};                    ///< HOST#PORT; empty: 127.0.0.1#53210
  double stale_after_s = kStaleAfter_s;  ///< [s]
  double relays_s = kVirtuoseRelays_s;   ///< [s]
};

class VirtuoseDevice final : public Device {
 public:
  static constexpr const char* kHost = "127.0.0.1#53210";
  /// No function tells the model or its limits: those of the weakest model, the Desktop [N], [N m].
  static constexpr double kMostForce_N = 10.0, kMostTorque_Nm = 0.7;
  static constexpr double kPeriod_s = 0.001;  ///< of the library's thread [s]
  static constexpr int kButtons = 3;          ///< 0 to 2: programs count them from 0 or from 1

  static Result<std::unique_ptr<Device>> connect(const VirtuoseOptions& options);
  static DriverSurvey survey();
  ~VirtuoseDevice() override { close(); }

  Result<void> open() override;
  void close() noexcept override;
  const DeviceInfo& info() const noexcept override { return info_; }
  bool read(double now_s, DeviceSample& sample) noexcept override;
  bool write(const Wrench& F_D) noexcept override;
  std::string trouble() const override;

 private:
  explicit VirtuoseDevice(VirtuoseOptions options) : options_(std::move(options)) {}
  Result<void> connect_once();
  Result<void> ask_abilities();
  Result<void> prepare();
  Result<void> start();
  Error failure(const std::string& what) const;
  static void on_tick(virt::Context context, void* self) noexcept;
  void tick() noexcept;
  bool measure(DeviceSample& sample) noexcept;
  bool ask_state(DeviceSample& sample) noexcept;
  bool send(const Wrench& F_D) const noexcept;

  VirtuoseOptions options_;
  VirtuoseLibrary virtuose_;
  virt::Context context_ = nullptr;
  bool is_open_ = false, runs_ = false;
  float period_s_ = static_cast<float>(kPeriod_s);  // the library keeps its address
  DeviceInfo info_;
  Vec3 origin_ = Vec3::Zero();  // of D, in the base frame [m]
  LoopExchange exchange_;
  // On the library's thread.
  int powered_ticks_ = 0;
  bool has_force_ = true;
  // What it said last.
  std::atomic<int> error_{0};
  std::atomic<bool> grip_sensed_{true}, operational_{true}, powered_{true};
};

}  // namespace tactum::inline v0_1
