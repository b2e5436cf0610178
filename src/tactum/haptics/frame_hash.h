#pragma once
/// The hash of a frame, so that two runs can be compared to the bit.

#include <span>

#include "tactum/base/hash.h"
#include "tactum/response/frame_report.h"

namespace tactum::inline v0_1 {

/// Adds everything that was computed and counted to the hash (a negative zero as zero): equal hashes mean
/// equal frames.
void add_to(FrameHash& hash, const FrameReport& report) noexcept;
/// The same for what other hands than the first have of it.
void add_to(FrameHash& hash, std::span<const HandReport> others) noexcept;
/// The same for the poses and velocities of the bodies.
void add_to(FrameHash& hash, const WorldState& state) noexcept;

}  // namespace tactum::inline v0_1
