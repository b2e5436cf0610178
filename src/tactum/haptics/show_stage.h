#pragma once
/// What the last stages of a frame need to know of the scene: the report of the grasp, what the device can
/// exert of the felt wrench, smoothed, and the energy that the scene has stored.

#include <cstdint>
#include <span>

#include "tactum/haptics/frame_state.h"
#include "tactum/response/step_input.h"

namespace tactum::inline v0_1 {

/// Reports what is grasped, and how.
void report_hand(const GraspedPart& grasped, FrameReport& report) noexcept;

/// Reports the probe and the handle where the step has left them; the handle, none while nothing is grasped.
PlacedHandle report_grasp(const GraspedPart& grasped, const WorldState& bodies, FrameReport& report) noexcept;

/// By how much a displacement `moved` of the handle can change the felt wrench, as the device has it.
/// `radius_m` is that of each body.
WrenchStep explained_by_hand(const FrameSettings& settings, const GraspedPart& grasped,
                             std::span<const double> radius_m, const Twist& moved) noexcept;

/// What the device can exert of the felt wrench (`at_handle`, as the device has it), smoothed. Torque is
/// smoothed also where the device drives none (SmoothingState::shown). Sets the safety flags of limits that
/// act.
Wrench smooth_for_device(const FrameSettings& settings, const WrenchStep& by_hand, const Wrench& at_handle,
                         SmoothingState& state, std::uint32_t& safety_flags) noexcept;

/// The energy of the scene after the step, the handle on the grasped part being where it has come to, and
/// `felt` what the response lets the hand feel, as the device has it.
StoredEnergy stored_in_scene(const World& world, const FrameSettings& settings, const GraspedPart& grasped,
                             const PlacedHandle& handle, const Wrench& felt,
                             const FrameState& state) noexcept;

/// What the energy balance of the port needs to know: `wanted` is the smoothed wrench with the caller's own.
PortInput port_input(const FrameSettings& settings, const Wrench& wanted, const Wrench& smoothed,
                     const StoredEnergy& stored, const SmoothingState& smoothing,
                     const SafetyState& safety) noexcept;

}  // namespace tactum::inline v0_1
