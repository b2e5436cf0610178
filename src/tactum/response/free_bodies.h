#pragma once
/// The bodies that move by themselves, in the constraint response: they fall, hit, slide and rest, and
/// penetrate nothing.
///
///     half of weight and load -> impacts -> the other half -> resting contact -> step on trial -> exact gaps
///                                                                    ^                                 |
///                                                                    '---- corrected, or halved <------'
///
/// A body's velocity is that of the middle of the frame, so that it falls on the exact parabola and a ball
/// that bounces without loss keeps its energy; impacts are solved with the velocity at the beginning of the
/// frame. Islands of bodies that touch are solved apart from each other (dynamics/islands.h), so that a jam
/// in one corner does not stop the rest. The island of the grasped part is the problem of constraint.h, whose
/// answer is exact, as long as there is room for it; otherwise it is solved here like the others.

#include "tactum/response/constraint_state.h"

namespace tactum::inline v0_1 {

/// Takes half a frame of weight and load (body_load.h) from the initial velocities of a world.
void begin_midway(const World& world, double dt_s, WorldState& state) noexcept;

/// Adds the effect of weight and load up to the beginning of the frame.
void pull_free_bodies(const MotionInput& input, WorldState& bodies) noexcept;

/// Whether any body but the grasped one moves.
bool others_move(const World& world, int grasped) noexcept;

/// Finds the islands, from the patches of the frame.
void find_islands(ConstraintStep& step) noexcept;

/// Applies impacts, and adds the other half of weight and load: afterwards every body that is not grasped has
/// the velocity that it keeps when no contact holds it.
void apply_impacts(ConstraintStep& step) noexcept;

/// Moves all islands but `grasped_island`.
void move_free_bodies(ConstraintStep& step) noexcept;

/// The rates at the end of the frame of the bodies that turn freely, from their mean ones.
void end_turning(ConstraintStep& step) noexcept;

}  // namespace tactum::inline v0_1
