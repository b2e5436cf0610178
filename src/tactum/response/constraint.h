#pragma once
/// The island of the grasped part in the `constraint` response: the grasped part is a god-object with six
/// degrees of freedom that goes where the hand wants it, as far as it penetrates nothing [Zilles 1995; Ortega
/// 2007].
///
///     rows: every corner of every patch  ->  nearest displacement  ->  scaled to the trust region radius
///        ^                                                                       |
///        '-- correction by exact gaps, then halved step <-- no -- is every gap open there? -- yes --> taken
///
/// A pose is taken only when the exact distance of every near pair of pieces has been computed there and is
/// open: with linear rows alone a part that turns would penetrate. Each remedy here answers a failure that
/// was seen, see docs/algorithms/constraint_response.md. Cost: 1-2 us for a peg in its hole.

#include "tactum/response/constraint_state.h"

namespace tactum::inline v0_1 {

/// How far points may move in the frame: the trust region radius for the grasped part, and for the bodies
/// that it may push the same beside their own motion. Fills own.motion_bound.
void bound_constrained_motion(const MotionInput& input, const WorldState& bodies,
                              ConstraintMemory& own) noexcept;

/// Moves everything that moves, the grasped part's island last. Fills the contact rows, the felt wrench and
/// the report's response fields.
void respond_constrained(ConstraintStep& step) noexcept;

}  // namespace tactum::inline v0_1
