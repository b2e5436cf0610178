#pragma once
/// A stage of the caller's own in the chain of forces: guidance, a texture, a vibration, the weight of the
/// handle.
///
///   contacts, coupling -> smoothing -> the caller's stage -> passivity -> safety -> device
///
/// The stages behind it watch its wrench as they watch the rest: what it adds fades when it has given the
/// hand more energy than it took (passivity.h), and no limit of safety.h can be passed.
/// FrameReport::smoothed is the wrench before this stage, FrameReport::shown the commanded wrench.

#include "tactum/devices/device.h"
#include "tactum/response/frame_report.h"

namespace tactum::inline v0_1 {

class ForceStage {
 public:
  virtual ~ForceStage() = default;
  /// The wrench that replaces `F_D`: on the hand, at the handle, axes of D [N, N m]. Called in the frame: it
  /// must not allocate, lock, throw or read a clock. `report` is filled up to FrameReport::smoothed. `sample`
  /// may be invalid, and is so until the device has been read once: look at DeviceSample::valid. A wrench
  /// that is not finite is a fault that safety answers with zero.
  virtual Wrench apply(const Wrench& F_D, const DeviceSample& sample, const FrameReport& report) noexcept = 0;

 protected:
  ForceStage() = default;
  ForceStage(const ForceStage&) = default;
  ForceStage& operator=(const ForceStage&) = default;
};

}  // namespace tactum::inline v0_1
