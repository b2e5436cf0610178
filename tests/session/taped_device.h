#pragma once
/// A motion that a simulated device makes in a scene, kept on a tape, and a driver whose device then makes
/// the same motion, reading by reading.

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "driver_stages.h"

namespace tactum {

/// What passed between a loop and a device.
struct Tape {
  std::vector<DeviceSample> measured, passed;  // as the device measured them, and through the driver
  std::vector<Wrench> wrenches;
};

/// A device within another one.
class Within : public Device {
 public:
  explicit Within(std::unique_ptr<Device> inner) : inner_(std::move(inner)) {}
  Result<void> open() override { return inner_->open(); }
  void close() noexcept override { inner_->close(); }
  const DeviceInfo& info() const noexcept override { return inner_->info(); }
  bool write(const Wrench& F_D) noexcept override { return inner_->write(F_D); }

 protected:
  std::unique_ptr<Device> inner_;
};

/// A simulated device in a hand, which says that it can what a driver's can, and is read through it.
class TapedDevice final : public Within {
 public:
  TapedDevice(std::unique_ptr<Device> inner, DeviceInfo info, const DriverStage& stage, Tape& tape)
      : Within(std::move(inner)), info_(std::move(info)), stage_(stage), tape_(tape) {}
  const DeviceInfo& info() const noexcept override { return info_; }
  bool read(double now_s, DeviceSample& sample) noexcept override {
    const bool good = inner_->read(now_s, sample);
    tape_.measured.push_back(sample);
    sample = stage_.passed(sample);
    tape_.passed.push_back(sample);
    return good;
  }
  bool write(const Wrench& F_D) noexcept override {
    tape_.wrenches.push_back(F_D);
    return Within::write(F_D);
  }

 private:
  DeviceInfo info_;
  const DriverStage& stage_;
  Tape& tape_;
};

/// The driver, whose device measures what the tape holds.
class SteppedDevice : public Within {
 public:
  SteppedDevice(std::unique_ptr<Device> inner, DriverStage& stage, const Tape& tape)
      : Within(std::move(inner)), stage_(stage), tape_(tape) {}
  void close() noexcept override {
    stage_.end();
    Within::close();
  }
  bool read(double now_s, DeviceSample& sample) noexcept override {
    const std::size_t at = measure(now_s);
    bool good = inner_->read(now_s, sample);
    // What goes by way of the network may still be on it.
    for (int n = 0; n < 1000 && sample.X_DH.p != tape_.passed[at].X_DH.p; ++n)
      good = inner_->read(now_s, sample);
    return good;
  }
  bool write(const Wrench& F_D) noexcept override {
    const bool taken = Within::write(F_D);
    if (reads_ > 0) stage_.after_write();
    return taken;
  }

 protected:
  /// The device is now as at the next place of the tape; which that is.
  std::size_t measure(double now_s) {
    const std::size_t at = std::min(reads_++, tape_.measured.size() - 1);
    if (at == 0) stage_.begin();
    stage_.measure(tape_.measured[at], now_s);
    return at;
  }

 private:
  DriverStage& stage_;
  const Tape& tape_;
  std::size_t reads_ = 0;
};

}  // namespace tactum
