#pragma once
/// The bodies that move by themselves, in the constraint response: they fall, hit, slide and rest, and
/// nothing enters anything.
///
///     half of gravity's push -> blows -> the other half -> resting contact -> step on trial -> exact gaps
///                                                                ^                                |
///                                                                '---- fed back, or halved <------'
///
/// A body's velocity is that of the middle of the frame, so that it falls on the exact parabola and a ball
/// that bounces without loss keeps its energy; blows are struck with the velocity at the beginning of the
/// frame. Islands of bodies that touch answer apart from each other (dynamics/islands.h), so that what is
/// stuck in one corner does not hold up the rest. The island of the held part is the problem of constraint.h,
/// whose answer is exact, as long as it has room for it; where not, it is solved here like the others.

#include "tactum/response/constraint_state.h"

namespace tactum::inline v0_1 {

/// Takes half a frame of gravity back from the velocities a world starts with.
void begin_midway(const World& world, double dt_s, WorldState& state) noexcept;

/// Gravity up to the beginning of the frame.
void pull_free_bodies(const MotionInput& input, WorldState& bodies) noexcept;

/// Whether any body but the held one moves.
bool others_move(const World& world, int grasped) noexcept;

/// Finds the islands, from the patches of the frame.
void find_islands(ConstraintStep& step) noexcept;

/// Applies impacts, and gives gravity's other half: afterwards every body that is not held
/// has the velocity with which it would go on if nothing held it.
void apply_impacts(ConstraintStep& step) noexcept;

/// Moves all islands but `grasped_island`.
void move_free_bodies(ConstraintStep& step) noexcept;

/// The rates at the end of the frame of the bodies that turn freely, from their mean ones.
void end_turning(ConstraintStep& step) noexcept;

}  // namespace tactum::inline v0_1
