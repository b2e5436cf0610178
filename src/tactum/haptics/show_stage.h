#pragma once
/// What the last stages of a frame need to know of the scene: the report of the grasp, what the device can
/// exert of the felt wrench, smoothed, and the energy that the scene has stored.

#include <cstdint>
#include <span>

#include "tactum/haptics/frame_state.h"
#include "tactum/response/step_input.h"

namespace tactum::inline v0_1 {

/// Begins the reports of a frame.
void begin_reports(const FrameTick& tick, FrameState& state, FrameReport& report) noexcept;

/// The report of a hand, counted from 0.
inline HandReport& report_of(std::size_t hand, FrameState& state, FrameReport& report) noexcept {
  return hand == 0 ? report : state.other_reports[hand - 1];
}

/// Reports what is grasped, and how.
void report_hands(std::span<const HandInput> hands, FrameState& state, FrameReport& report) noexcept;

/// Adds the work of fields, of loads and, where there are several hands, of their couplings over the step.
void add_work(const World& world, const FrameSettings& settings, std::span<const HandInput> hands,
              FrameState& state) noexcept;

/// Reports the probe of a hand, its handle where the step has left that, and the wrench that is felt there.
/// Of a hand that is not known yet there is nothing to report.
void feel_grasp(const StepInput& step, std::size_t hand, FrameState& state, FrameReport& report) noexcept;

/// By how much the displacements of all handles in this frame can change a felt wrench, as a device has it:
/// what one hand does another may feel. `radius_m` is that of each body.
WrenchStep explained_by_hands(const FrameSettings& settings, std::span<const double> radius_m,
                              const FrameState& state) noexcept;

/// What the device can exert of the felt wrench (`at_handle`, as the device has it), smoothed. Torque is
/// smoothed also where the device drives none (SmoothingState::shown). Sets the safety flags of limits that
/// act.
Wrench smooth_for_device(const HandSettings& settings, double dt_s, const WrenchStep& by_hands,
                         const Wrench& at_handle, SmoothingState& state,
                         std::uint32_t& safety_flags) noexcept;

/// The energy of the scene after the step, as a hand sees it; `felt` is what the response lets it feel, as
/// the device has it.
StoredEnergy stored_in_scene(const World& world, const FrameSettings& settings, std::size_t hand,
                             const Wrench& felt, const FrameState& state) noexcept;

/// What the energy balance of a hand's port needs to know: `wanted` is the smoothed wrench with the caller's
/// own.
PortInput port_input(double dt_s, const Wrench& wanted, const Wrench& smoothed, const StoredEnergy& stored,
                     const HandFrameState& state) noexcept;

}  // namespace tactum::inline v0_1
