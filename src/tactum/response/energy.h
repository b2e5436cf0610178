#pragma once
/// What a scene has stored, for the balance of the passivity stage: springs and moving bodies.

#include "tactum/loop/passivity.h"
#include "tactum/response/frame_report.h"
#include "tactum/response/settings.h"

namespace tactum::inline v0_1 {

/// Kinetic energy of the bodies that move, and their height against gravity from the world's origin [J]. The
/// held part weighs nothing.
double bodies_energy(const World& world, const WorldState& bodies, int grasped) noexcept;

/// Fills the energies of the port's input, after the response: of the bodies, of the coupling's stretch
/// between the hand and the held part, as the report has them, and of the impulses that are still to be felt
/// (`pending_J`). `field_work_J` is what force fields have given the held part.
void add_stored_energy(const World& world, const Coupling& coupling, const WorldState& bodies,
                       const FrameReport& report, double field_work_J, double pending_J,
                       PortInput& port) noexcept;

}  // namespace tactum::inline v0_1
