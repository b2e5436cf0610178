#pragma once
/// What a run tells a recorder (recording/recorder.h): everything that comes into a frame, and the frame.

#include <span>

#include "tactum/session/command.h"
#include "tactum/telemetry/channels.h"
#include "tactum/telemetry/run_record.h"

namespace tactum::inline v0_1 {

/// Called in the loop's thread, and bound by the rules of a frame: no allocation, no lock, no clock.
class RunListener {
 public:
  virtual ~RunListener() = default;
  /// A command was carried out, before the frame `index`.
  virtual void obeyed(std::uint64_t index, const SessionCommand& command) noexcept = 0;
  /// A frame is over. `tick` is the one it was computed with, a held wrench included, and `refused` as the
  /// first hand's device has it; `others` are the samples of the second hand and all after it. `clock` may be
  /// null.
  virtual void frame_over(const DeviceSample& sample, const FrameTick& tick,
                          std::span<const HandSample> others, const FrameSource& frame,
                          const StageClock* clock) noexcept = 0;

 protected:
  RunListener() = default;
  RunListener(const RunListener&) = default;
  RunListener& operator=(const RunListener&) = default;
};

}  // namespace tactum::inline v0_1
