#pragma once
/// Everything that a frame carries to the next one, as bytes and back: a run that is begun from a snapshot
/// goes on to the bit (base/carried_state.h).

#include <cstdint>
#include <span>
#include <string_view>

#include "tactum/haptics/frame_state.h"

namespace tactum::inline v0_1 {

/// Writes the state between two frames, where it fits into `room`; returns how many bytes it has. Allocates
/// nothing; cost: about a nanosecond for every four bytes.
std::size_t write_snapshot(const FrameState& state, std::span<char> room) noexcept;

/// What a snapshot is of: another number means another program, or another response.
std::uint64_t snapshot_layout(const FrameState& state) noexcept;

/// Which part of the state the byte of a snapshot belongs to: "contacts", "response".
const char* snapshot_part(const FrameState& state, std::size_t byte) noexcept;

/// Sets a state that was made of the same world and settings. An error where the bytes are not such a state;
/// the state is then of no use.
Result<void> read_snapshot(std::string_view bytes, FrameState& state);

}  // namespace tactum::inline v0_1
