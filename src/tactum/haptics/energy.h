#pragma once
/// What a scene has stored, for the ledger of the passivity stage: springs and moving bodies.

#include "tactum/haptics/frame_report.h"
#include "tactum/haptics/frame_state.h"

namespace tactum {

/// Kinetic energy of the bodies that move, and their height against gravity from the world's origin [J]. The
/// held part weighs nothing.
double bodies_energy(const World& world, const WorldState& state, int held) noexcept;

/// What the passivity stage is told, after the response.
PortInput port_input(const World& world, const FrameSettings& settings, const FrameState& state,
                     const FrameReport& report) noexcept;

}  // namespace tactum
