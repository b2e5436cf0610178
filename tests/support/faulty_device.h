#pragma once
/// A device that breaks on a schedule: another device, and the faults that real ones have, each from a time
/// to a time on the loop's clock. The other device knows which wrench reaches the hand, and can be queried.

#include <memory>
#include <utility>
#include <vector>

#include "tactum/devices/simulated_device.h"
#include "tactum/math/screw.h"

namespace tactum {

enum class Fault {
  kNone,
  kReadsFail,  ///< the read reports it; the sample is the last one, marked invalid
  kRepeated,   ///< reads succeed with the last sample, its time included: a driver's stale buffer
  kFrozen,     ///< reads succeed, the time goes on, the pose does not: an encoder's lost cable
  kLeapt,      ///< the pose is off by FaultSpan::leap
  kNotFinite,  ///< a NaN in the pose
  kZeros,      ///< a buffer of zeros for a pose
  kWildTime,   ///< the sample's time is that of another clock
  kRefuses,    ///< writes are refused, the motors are off: unplugged
  kMotorsOff,  ///< writes are taken, the motors are off, and the sample reports it: dead-man switch, no power
  kMotorsOffMute,  ///< ... without a report
};

struct FaultSpan {
  Fault fault = Fault::kNone;
  double from_s = 0.0, to_s = 0.0;  ///< [s]
  Pose leap;                        ///< in front of the pose, of kLeapt [m]
};

class FaultyDevice final : public Device {
 public:
  FaultyDevice(SimulatedDevice& device, std::vector<FaultSpan> faults)
      : device_(device), faults_(std::move(faults)), info_(device.info()) {}

  Result<void> open() override { return device_.open(); }
  void close() noexcept override { device_.close(); }
  const DeviceInfo& info() const noexcept override { return info_; }
  DeviceInfo& info() noexcept { return info_; }

  bool read(double now_s, DeviceSample& sample) noexcept override {
    now_s_ = now_s;
    DeviceSample good;
    const bool done = device_.read(now_s, good);
    const DeviceSample last = std::exchange(last_, good);
    const FaultSpan* now = acting();
    const Fault fault = now ? now->fault : Fault::kNone;
    if (fault == Fault::kReadsFail || fault == Fault::kRepeated || fault == Fault::kFrozen) last_ = last;
    sample = last_;
    if (fault == Fault::kReadsFail) sample.valid = false;
    if (fault == Fault::kFrozen) sample.time_s = now_s;
    if (fault == Fault::kLeapt) sample.X_DH = now->leap * sample.X_DH;
    if (fault == Fault::kNotFinite) sample.X_DH.p.y() = std::nan("");
    if (fault == Fault::kZeros) sample.X_DH = {Mat3::Zero(), Vec3::Zero()};
    if (fault == Fault::kWildTime) sample.time_s = 1e9;
    if (fault == Fault::kMotorsOff) sample.motors_on = false;
    return done && fault != Fault::kReadsFail;
  }

  bool write(const Wrench& F_D) noexcept override {
    const FaultSpan* now = acting();
    const Fault fault = now ? now->fault : Fault::kNone;
    const bool off = fault == Fault::kRefuses || fault == Fault::kMotorsOff || fault == Fault::kMotorsOffMute;
    return device_.write(off ? Wrench{} : F_D) && fault != Fault::kRefuses;
  }

 private:
  const FaultSpan* acting() const noexcept {
    for (const FaultSpan& span : faults_)
      if (now_s_ >= span.from_s && now_s_ < span.to_s) return &span;
    return nullptr;
  }

  SimulatedDevice& device_;
  std::vector<FaultSpan> faults_;
  DeviceInfo info_;
  double now_s_ = 0.0;
  DeviceSample last_;
};

}  // namespace tactum
