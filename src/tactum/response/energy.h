#pragma once
/// The energy that a scene has stored, for the balance of the passivity stage: in springs and moving bodies.

#include "tactum/loop/passivity.h"
#include "tactum/response/settings.h"
#include "tactum/response/step_input.h"

namespace tactum::inline v0_1 {

/// Kinetic energy of the bodies that move, and their height against gravity from the world's origin [J]. Of
/// the grasped part only the height is counted: it has weight, but no inertia that the hand could feel.
double bodies_energy(const World& world, const WorldState& bodies, int grasped) noexcept;

/// Fills the energies of the port's input, after the response: of the bodies, of the coupling's stretch
/// between the handle on the grasped part and the hand (`to_hand`), and of the impulses that are still to be
/// felt (`pending_J`). `outside_work_J` is the work of force fields on the grasped part and of the loads of
/// all bodies (work_of_loads). All become energies at the device, those of the scene over the workspace scale
/// (workspace_scale.h).
void add_stored_energy(const World& world, const FrameSettings& settings, const WorldState& bodies,
                       int grasped, const Twist& to_hand, double outside_work_J, double pending_J,
                       PortInput& port) noexcept;

}  // namespace tactum::inline v0_1
