#pragma once
/// A guided first touch without hardware: a simulated device whose hand does what it is asked to do, and a
/// clock that goes as fast as the machine. For people who want to see what the guide asks before they touch a
/// real device, and for tests.

#include <memory>

#include "tactum/devices/simulated_device.h"
#include "tactum/session/first_touch.h"

namespace tactum::inline v0_1 {

/// A clock that stands but when it is waited for.
class RehearsalClock final : public TouchClock {
 public:
  double now_s() noexcept override { return now_s_; }
  void wait_until(double time_s) noexcept override { now_s_ = time_s > now_s_ ? time_s : now_s_; }

 private:
  double now_s_ = 0.0;
};

/// The device, and the hand at it.
class RehearsedDevice final : public Device {
 public:
  RehearsedDevice(const SimulatedDeviceModel& model, const HandModel& hand);

  Result<void> open() override { return device_.open(); }
  void close() noexcept override { device_.close(); }
  const DeviceInfo& info() const noexcept override { return device_.info(); }
  bool read(double now_s, DeviceSample& sample) noexcept override;
  bool write(const Wrench& F_D) noexcept override { return device_.write(F_D); }

  /// The hand begins to do what is asked. Before the next read.
  void obey(const TouchRequest& request);

 private:
  class Hand;

  HandModel grip_;
  std::shared_ptr<Hand> hand_;
  SimulatedDevice device_;
};

}  // namespace tactum::inline v0_1
