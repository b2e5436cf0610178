#pragma once
/// The contact problems of the islands that move by themselves: assembled, solved, and taken apart again, one
/// island after the other.

#include "tactum/response/constraint_state.h"

namespace tactum::inline v0_1 {

/// Whether move_free_bodies() moves a body: one that moves, in an island other than that of constraint.h.
bool moves_here(const ConstraintStep& step, std::size_t body) noexcept;

/// The twist that leads a body through the frame's displacement: its velocity, and the detour by impacts.
Twist mean_twist(const ConstraintStep& step, std::size_t body) noexcept;

/// Groups bodies and contact rows by island, and keeps the velocities as those without contact.
void begin_islands(ConstraintStep& step) noexcept;

/// Solves for the velocities of the bodies in all islands that are not settled, from those without contact.
/// Sets the impulses of their rows, and what is kept for the next frame. May be called again after rows were
/// corrected.
void solve_islands(ConstraintStep& step) noexcept;

}  // namespace tactum::inline v0_1
