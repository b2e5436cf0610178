#pragma once
/// The devices of several hands as the one device of a loop. Each has its own samples and its own wrench, and
/// each may be lost without the others: its reads and writes fail then, and safety leads its own wrench to
/// zero (loop/safety.h).
///
/// The loop knows one wrench only. It is given the largest of all, as computed by the frame; a wrench of
/// exactly zero, as at the end of a stop, in a fault and where a frame came too late, is zero for all hands.

#include <memory>
#include <span>
#include <vector>

#include "tactum/loop/loop.h"

namespace tactum::inline v0_1 {

class HandDevices final : public Device {
 public:
  /// At least one device, none of them null; in the order of the hands.
  explicit HandDevices(std::vector<std::unique_ptr<Device>> devices);
  ~HandDevices() override { HandDevices::close(); }

  /// Opens all of them. On an error those that were opened are closed again.
  Result<void> open() override;
  void close() noexcept override;
  /// That of the first hand's device.
  const DeviceInfo& info() const noexcept override { return devices_.front()->info(); }
  /// Reads all devices; `sample` is that of the first. True while some device answers.
  bool read(double now_s, DeviceSample& sample) noexcept override;
  /// Writes the wrench of each hand, or zero to all where `F_D` is zero. True while some device takes its
  /// own.
  bool write(const Wrench& F_D) noexcept override;
  /// What the devices say is wrong with them.
  std::string trouble() const override;

  Device& device(std::size_t hand) noexcept { return *devices_[hand]; }
  const Device& device(std::size_t hand) const noexcept { return *devices_[hand]; }
  std::size_t hands() const noexcept { return devices_.size(); }
  /// The samples of the last read, by hand.
  std::span<const HandSample> samples() const noexcept { return samples_; }
  /// The wrenches of the next write, by hand, for the frame to fill.
  std::span<Wrench> wrenches() noexcept { return wrenches_; }
  /// The largest force of these wrenches, or the largest torque where there is no force: zero when all are.
  Wrench largest() const noexcept;

 private:
  std::vector<std::unique_ptr<Device>> devices_;
  std::vector<HandSample> samples_;
  std::vector<Wrench> wrenches_;
};

}  // namespace tactum::inline v0_1
