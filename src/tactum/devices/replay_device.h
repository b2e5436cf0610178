#pragma once
/// A device that plays a motion: the hand of a recording that no wrench can move. It takes force and torque
/// as a device of its class does, so that a run against it computes, limits and reports the same wrench; the
/// wrench is counted, and nobody feels it.

#include <memory>
#include <string>

#include "tactum/devices/device.h"
#include "tactum/devices/hand_motion.h"

namespace tactum::inline v0_1 {

/// What the handle does when the motion is over.
enum class AtEnd {
  kRest,   ///< the handle stays at the last pose
  kRepeat  ///< from the beginning; a recording that does not end where it began jumps
};

struct ReplaySettings {
  AtEnd at_end = AtEnd::kRest;
  double max_force_N = 8.5;          ///< wrenches are limited to this [N]
  double max_torque_Nm = 0.188;      ///< [N m]
  double workspace_radius_m = 0.12;  ///< reported in DeviceInfo [m]
};

class ReplayDevice final : public Device {
 public:
  /// `name` is shown, mostly the file's.
  ReplayDevice(std::string name, std::shared_ptr<const HandMotion> motion, const ReplaySettings& settings);

  Result<void> open() override;
  void close() noexcept override { is_open_ = false; }
  const DeviceInfo& info() const noexcept override { return info_; }
  bool read(double now_s, DeviceSample& sample) noexcept override;
  bool write(const Wrench& F_D) noexcept override;

  bool finished() const noexcept { return finished_; }  ///< the last read was past the end, and no repeat
  long writes() const noexcept { return writes_; }
  long saturated_writes() const noexcept { return saturated_writes_; }
  const Wrench& last_wrench() const noexcept { return last_; }  ///< limited, felt by nobody [N, N m]

 private:
  std::shared_ptr<const HandMotion> motion_;
  ReplaySettings settings_;
  DeviceInfo info_;
  bool is_open_ = false;
  bool started_ = false;
  bool finished_ = false;
  double start_s_ = 0.0;  // of the first read, the loop's clock
  long writes_ = 0;
  long saturated_writes_ = 0;
  Wrench last_;
};

}  // namespace tactum::inline v0_1
