#include "tactum/recording/record_switch.h"

#include <thread>

namespace tactum::inline v0_1 {

void RecordSwitch::lead_to(RunListener* listener) noexcept {
  RunListener* const before = wanted_.exchange(listener);
  while (before != nullptr && within_.load() == before) std::this_thread::yield();
}

/// Says that it is within before it looks again who is wanted: either lead_to() sees it there, or it sees
/// that another is wanted.
RunListener* RecordSwitch::enter() noexcept {
  RunListener* const listener = wanted_.load();
  if (listener == nullptr) return nullptr;
  within_.store(listener);
  if (wanted_.load() == listener) return listener;
  leave();
  return nullptr;
}

void RecordSwitch::obeyed(std::uint64_t index, const SessionCommand& command) noexcept {
  RunListener* const listener = enter();
  if (listener == nullptr) return;
  listener->obeyed(index, command);
  leave();
}

void RecordSwitch::frame_over(const DeviceSample& sample, const FrameTick& tick,
                              std::span<const HandSample> others, const FrameSource& frame,
                              const StageClock* clock) noexcept {
  RunListener* const listener = enter();
  if (listener == nullptr) return;
  listener->frame_over(sample, tick, others, frame, clock);
  leave();
}

}  // namespace tactum::inline v0_1
