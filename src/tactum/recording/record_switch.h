#pragma once
/// A recorder put into a run that goes on, and taken out again. The session reports to the switch from its
/// start; the loop never waits for it.

#include <atomic>

#include "tactum/session/run_listener.h"

namespace tactum::inline v0_1 {

class RecordSwitch final : public RunListener {
 public:
  /// Any thread but the loop's: from the next frame on everything is passed to `listener`; null for nobody.
  /// Returns when the loop has left the one before, which takes a part of a frame at most.
  void lead_to(RunListener* listener) noexcept;

  void obeyed(std::uint64_t index, const SessionCommand& command) noexcept override;
  void frame_over(const DeviceSample& sample, const FrameTick& tick, std::span<const HandSample> others,
                  const FrameSource& frame, const StageClock* clock) noexcept override;

 private:
  RunListener* enter() noexcept;
  void leave() noexcept { within_.store(nullptr, std::memory_order_release); }

  std::atomic<RunListener*> wanted_{nullptr};
  std::atomic<RunListener*> within_{nullptr};  // the loop's thread is about to call it, or does
};

}  // namespace tactum::inline v0_1
