#pragma once
/// One haptic frame: from the samples of the devices to their wrenches. The heart; read frame.cpp from top to
/// bottom.

#include "tactum/haptics/frame_state.h"
#include "tactum/loop/loop.h"
#include "tactum/response/frame_report.h"

namespace tactum::inline v0_1 {

/// The wrench for each hand, axes of its device, at its handle [N, N m]. A function of its arguments: it
/// allocates nothing, locks nothing, throws nothing and reads no clock, and the same inputs give the same
/// bits.
///
/// `samples` and `wrenches` have an entry for each hand of the settings; `tick.refused` is not read. While a
/// hand is not known yet, its part stays where it is; nothing moves until one is.
///
/// Two lengths of a frame come in: `settings.dt_s`, with which everything moves, and `tick.period_s`, with
/// which safety runs its ramps. The caller makes them equal. `report`, and state.other_reports for the other
/// hands, are begun anew; what the frame did not reach keeps its default, as the poses of probe and proxy do
/// until the hand is known.
void haptic_frame(const World& world, const FrameSettings& settings, std::span<const HandSample> samples,
                  const FrameTick& tick, FrameState& state, FrameReport& report,
                  std::span<Wrench> wrenches) noexcept;

/// The same for settings with one hand: returns its wrench.
Wrench haptic_frame(const World& world, const FrameSettings& settings, const DeviceSample& sample,
                    const FrameTick& tick, FrameState& state, FrameReport& report) noexcept;

}  // namespace tactum::inline v0_1
