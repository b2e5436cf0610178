#pragma once
/// Devices of 3D Systems (Touch, Touch X, PHANToM Premium) through HDAPI (hd_library.h). The library owns a
/// thread that calls us 1000 times a second, to read and to push within one of its frames; sample and command
/// are exchanged with the loop's thread (loop_exchange.h). So a command may wait for a period;
/// `handle.delay_s` says so. Device axes (x right, y up, z toward the user, millimetres) are turned into D:
/// (x, y, z)_D = (z, x, y) / 1000, from the middle of the usable workspace.
///
/// A device that is not calibrated reports that its motors are off, so the loop sends zero until it is. The
/// delivered wrench is that of the library's last frame, where the library has it.

#include <atomic>
#include <memory>
#include <string>

#include "tactum/drivers/hd_library.h"
#include "tactum/drivers/loop_exchange.h"
#include "tactum/drivers/survey.h"

namespace tactum::inline v0_1 {

struct TouchOptions {
  std::string name;                      ///< as in the maker's set-up program; empty: its default device
  double stale_after_s = kStaleAfter_s;  ///< [s]
};

class TouchDevice final : public Device {
 public:
  /// Whatever the device says, it is asked for no more than a PHANToM Premium 1.5 can [N], [N m].
  static constexpr double kMostForce_N = 8.5, kMostTorque_Nm = 0.188;
  static constexpr int kTicksPerCalibrationCheck = 500;  ///< of the library's thread

  static Result<std::unique_ptr<Device>> connect(const TouchOptions& options);
  static DriverSurvey survey();
  ~TouchDevice() override { close(); }

  Result<void> open() override;
  void close() noexcept override;
  const DeviceInfo& info() const noexcept override { return info_; }
  bool read(double now_s, DeviceSample& sample) noexcept override;
  bool write(const Wrench& F_D) noexcept override;
  std::string trouble() const override;

 private:
  explicit TouchDevice(TouchOptions options) : options_(std::move(options)), id_(hd::kInvalidHandle) {}
  Result<void> connect_once();
  void ask_abilities();
  void ask_workspace();
  void calibrate() noexcept;
  static unsigned on_tick(void* self) noexcept;
  void tick() noexcept;
  void measure(DeviceSample& sample) const noexcept;
  void push() noexcept;
  std::uint32_t drain_errors() noexcept;

  TouchOptions options_;
  HdLibrary hd_;
  unsigned id_;  // HDAPI's handle of the device
  bool is_open_ = false;
  DeviceInfo info_;
  Vec3 centre_D_ = Vec3::Zero();  // of the workspace, from HDAPI's origin [m]
  unsigned long task_ = 0;
  LoopExchange exchange_;
  // On the library's thread.
  int ticks_ = 0;                // since the calibration was asked for
  bool has_last_wrench_ = true;  // the library knows its last frame's
  // What it said last.
  std::atomic<unsigned> error_{0};  // the last that matters
  std::atomic<bool> calibrated_{false};
};

}  // namespace tactum::inline v0_1
