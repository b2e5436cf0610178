#pragma once
/// One haptic frame: from a device sample to a wrench. The heart; read frame.cpp from top to bottom.

#include "tactum/haptics/frame_state.h"
#include "tactum/loop/loop.h"
#include "tactum/response/frame_report.h"

namespace tactum::inline v0_1 {

/// The wrench for the hand, device axes, at the handle [N, N m]. A function of its arguments: it allocates
/// nothing, locks nothing, throws nothing and reads no clock, and the same inputs give the same bits.
///
/// Two lengths of a frame come in: `settings.dt_s`, with which everything moves, and `tick.period_s`, with
/// which safety runs its ramps. The caller makes them equal. `report` is begun anew; what the frame did not
/// reach keeps its default, as the poses of probe and proxy do until the hand is known.
Wrench haptic_frame(const World& world, const FrameSettings& settings, const DeviceSample& sample,
                    const FrameTick& tick, FrameState& state, FrameReport& report) noexcept;

}  // namespace tactum::inline v0_1
