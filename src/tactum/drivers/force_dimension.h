#pragma once
/// Devices of Force Dimension (omega, delta, sigma, lambda) and the Novint Falcon, through the maker's
/// library (dhd_library.h). The loop's thread asks the device and sends to it, a USB transfer each time.
///
///   connect   load, open, ask for abilities           no motor is on
///   open      limits and watchdog set, a zero wrench, then forces on and asked whether they are
///   close     a zero wrench, forces off (which brakes), released
///
/// Its axes are those of D, its units SI, so pose and wrench pass as they are, to the bit. A device that is
/// not calibrated is refused: the library would move it by itself, and that must not surprise a hand.
/// The gripper's force is always zero; a gripper that is closed is button 0, where the library can do so.
///
/// Three things keep old commands away from the hand: the loop's safety stage, the StaleGuard, and the
/// device's own watchdog, which is set to kWatchdog_s. When that has switched forces off, because the machine
/// stood still, the loop is told so and sends zero; then they are switched on again, and the loop begins its
/// start ramp. What the user or the device's velocity limit switched off stays off; that limit is left as
/// the maker set it.

#include <memory>
#include <string>

#include "tactum/drivers/command_guard.h"
#include "tactum/drivers/dhd_library.h"
#include "tactum/drivers/survey.h"

namespace tactum::inline v0_1 {

struct ForceDimensionOptions {
  std::string serial;                    ///< of the device; empty: the first that is free
  double stale_after_s = kStaleAfter_s;  ///< of the guard [s]
};

class ForceDimensionDevice final : public Device {
 public:
  static constexpr double kWatchdog_s = 0.025;    ///< in steps of 125 us, after the guard's time [s]
  static constexpr double kStatusEvery_s = 0.01;  ///< how often the device's state is asked for [s]

  static Result<std::unique_ptr<Device>> connect(const ForceDimensionOptions& options);
  static DriverSurvey survey();
  ~ForceDimensionDevice() override { close(); }

  Result<void> open() override;
  void close() noexcept override;
  const DeviceInfo& info() const noexcept override { return info_; }
  bool read(double now_s, DeviceSample& sample) noexcept override;
  bool write(const Wrench& F_D) noexcept override;
  std::string trouble() const override;

 private:
  explicit ForceDimensionDevice(ForceDimensionOptions options) : options_(std::move(options)) {}
  Result<void> connect_once();
  Result<void> open_by_serial();
  void ask_abilities();
  void ask_inertia();
  void set_limits() const;
  Error failure(const std::string& what, const std::string& cure) const;
  bool send(const Wrench& F_D) const noexcept;
  bool read_pose(DeviceSample& sample) noexcept;
  void read_velocity(DeviceSample& sample) const noexcept;
  void ask_status(double now_s) noexcept;

  ForceDimensionOptions options_;
  DhdLibrary dhd_;
  int id_ = -1;  // of the device in the library; negative: not connected
  bool is_open_ = false;
  DeviceInfo info_;
  bool has_gripper_ = false;
  CommandGate gate_;
  StaleGuard guard_;
  // What the device said when it was last asked.
  bool answers_ = true;
  bool motors_on_ = true;
  bool has_delivered_ = false;
  Wrench delivered_;
  double asked_s_ = 0.0;  // when, on the loop's clock
  bool asked_ = false;
  int force_off_cause_ = 0;
};

}  // namespace tactum::inline v0_1
