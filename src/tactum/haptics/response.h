#pragma once
/// The stages of the response that frame.cpp strings together: the penalty response as published [Gregory
/// 2000, 5.2, 6.1], or the constraint response (constraint.h), as the settings say.

#include "tactum/haptics/frame_report.h"
#include "tactum/haptics/frame_state.h"

namespace tactum {

/// The first time the hand is known, the device is mapped so that the handle stands at the tool's grasp point
/// and the part is grasped in the orientation it has: nothing is pulled.
void grasp(const FrameSettings& settings, FrameState& state) noexcept;

/// How fast does everything want to move: the held part towards the hand, at most the threshold distance;
/// free bodies as they moved, pulled by gravity; all as their joints allow. Fills state.world.V_WB and
/// state.resistance.
void wanted_velocities(const World& world, const FrameSettings& settings, double dt_s,
                       FrameState& state) noexcept;

/// v_c dt of every body: linear and angular speed bound [Gregory 2000, 5.2]. Fills state.reach.
void tolerances_from_speed(const World& world, const FrameSettings& settings, double dt_s,
                           FrameState& state) noexcept;

/// What the response needs to know of a patch: points that carry its force, or its features.
PatchPoints points_wanted(const FrameSettings& settings) noexcept;

/// Penalty: advances to the smallest time of impact, applies the contact forces, advances with the new
/// velocities for the rest of the frame, and puts every transform back on its joint. Constraint: moves
/// everything as far as nothing is entered. Fills the report's response fields.
void respond(const World& world, const FrameSettings& settings, double dt_s, FrameState& state,
             FrameReport& report) noexcept;

/// The raw wrench at the handle: the coupling from the hand to the proxy, or the sum of the constraint
/// forces. Zero when nothing is held.
Wrench felt_wrench(const FrameSettings& settings, FrameState& state, FrameReport& report) noexcept;

}  // namespace tactum
