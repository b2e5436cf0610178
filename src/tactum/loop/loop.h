#pragma once
/// The loop: read the device, run the frame, write the wrench, at a fixed rate. Two drivers run it:
///
///   run_virtual   (here)            a virtual clock, as fast as it goes; the same inputs give the same bits
///   LoopThread    (loop_thread.h)   real time, absolute deadlines
///
/// The frame reads no clock: its duration is measured by the driver, around the call.

#include <cstdint>

#include "tactum/base/result.h"
#include "tactum/devices/device.h"

namespace tactum::inline v0_1 {

/// The input of a frame from the loop, beside the sample.
struct FrameTick {
  std::uint64_t index = 0;  ///< frames since the start
  double now_s = 0.0;       ///< on the loop's clock, zero at the start [s]
  double period_s = 0.001;  ///< nominal time between frames [s]
  bool late = false;        ///< this frame comes later than the loop's late limit allows
  bool refused = false;     ///< the device did not take the last frame's wrench
  bool stop = false;        ///< lead the wrench to zero; the loop ends when it is
};

/// The input of a frame from the device of one hand.
struct HandSample : DeviceSample {
  bool refused = false;  ///< the device did not take the last frame's wrench; FrameTick::refused of this hand
};

/// The work of one frame, as the loop sees it.
class HapticFrame {
 public:
  virtual ~HapticFrame() = default;
  /// The wrench on the hand, axes of D, at the handle. No allocation, no lock, no clock.
  virtual Wrench run(const DeviceSample& sample, const FrameTick& tick) noexcept = 0;

 protected:
  HapticFrame() = default;
  HapticFrame(const HapticFrame&) = default;
  HapticFrame& operator=(const HapticFrame&) = default;
};

/// One frame of a virtual run, after the write.
struct FrameRecord {
  FrameTick tick;
  DeviceSample sample;
  Wrench F_D;                 ///< sent [N, N m]
  bool written = false;       ///< the device took it
  double frame_time_s = 0.0;  ///< of HapticFrame::run, on the steady clock [s]
};

/// Called after every frame of a virtual run, outside the measured time.
class LoopObserver {
 public:
  virtual ~LoopObserver() = default;
  /// False asks for a stop: the wrench is led to zero and the run ends.
  virtual bool after_frame(const FrameRecord& record) noexcept = 0;

 protected:
  LoopObserver() = default;
  LoopObserver(const LoopObserver&) = default;
  LoopObserver& operator=(const LoopObserver&) = default;
};

struct VirtualRun {
  std::uint64_t frames = 0;  ///< run, those of a stop included
  std::uint64_t failed_reads = 0;
  std::uint64_t failed_writes = 0;
  bool stopped_early = false;  ///< the observer asked for it
};

/// A stop that takes longer than this is cut: zero is written and the device closed [s].
inline constexpr double kMaxStop_s = 0.5;

/// Opens the device, runs `n_frames` at `rate_Hz` on a virtual clock (frame i at i / rate), writes zero,
/// closes. `observer` may be null; frame times are measured only when it is not.
Result<VirtualRun> run_virtual(Device& device, HapticFrame& frame, double rate_Hz, std::uint64_t n_frames,
                               LoopObserver* observer = nullptr);

/// Exactly zero, which ends a stop.
inline bool is_zero(const Wrench& F) { return F.f.isZero(0.0) && F.t.isZero(0.0); }

/// An error unless a loop can run at this rate.
Result<void> check_rate(double rate_Hz);

}  // namespace tactum::inline v0_1
