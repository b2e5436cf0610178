#pragma once
/// The grasped part in the constraint response: where the hand, its own weight and force fields would have
/// it, and the wrench that the hand feels where it went instead. It has weight, but no inertia that could be
/// felt.

#include "tactum/response/constraint_state.h"

namespace tactum::inline v0_1 {

/// The displacement of the handle that the coupling asks for in this frame, world axes, (m, rad).
Vec6 wanted_by_hand(const ConstraintStep& step) noexcept;
/// The displacement that `wanted` becomes when weight, force fields and the constant force and torque on the
/// grasped part load it, (m, rad).
Vec6 with_load(const ConstraintStep& step, const Vec6& wanted) noexcept;
/// Adds the grasped part to a contact problem: its coupling over one frame, and its damping, are its metric;
/// `target` is the displacement of the handle without damping.
void add_grasped(const Vec6& target, const ConstraintStep& step, ContactProblem& problem) noexcept;
/// The displacement of the handle in the problem's last answer, (m, rad).
Vec6 displacement_of_handle(const ContactProblem& problem, const ConstraintStep& step) noexcept;
/// Sets ConstraintState::felt to the wrench that the hand feels when the handle moves by `displacement` (m,
/// rad) from where it is, in place of ConstraintState::wanted.
void feel(const Vec6& displacement, ConstraintStep& step) noexcept;

}  // namespace tactum::inline v0_1
