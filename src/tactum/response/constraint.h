#pragma once
/// The island of the held part in the `constraint` response: the held part is a god-object with six degrees
/// of freedom that goes where the hand wants it as far as nothing is entered [Zilles 1995; Ortega 2007].
///
///     rows: every corner of every patch  ->  nearest displacement  ->  scaled to the trusted length
///        ^                                                                       |
///        '-- exact gaps at the new pose are fed back, the step halved <-- is every gap open there? --> go
///
/// A pose is only taken when the exact distance of every near pair of pieces has been computed there and is
/// open: linear rows alone would let a turning part in. Each remedy here was a failure first, see
/// docs/algorithms/constraint_response.md. Cost: 1-2 us for a peg in its hole.

#include "tactum/response/constraint_state.h"

namespace tactum::inline v0_1 {

/// How far points may move in the frame: the trusted length for the held part and, on top of their own way,
/// for what it may push. Fills own.motion_bound.
void bound_constrained_motion(const MotionInput& input, const WorldState& bodies,
                              ConstraintMemory& own) noexcept;

/// Moves everything that moves, the held part's island last. Fills the contact rows, the felt wrench and
/// the report's response fields.
void respond_constrained(ConstraintStep& step) noexcept;

}  // namespace tactum::inline v0_1
