#pragma once
/// The grasped part in the constraint response: where the hand, its own weight and force fields would have
/// it, and the wrench that the hand feels where it went instead. It has weight, but no inertia that could be
/// felt. Hands are counted from 0. A part that several hold has the sum of their metrics and of the forces by
/// which they lead it to their targets; its weight and load are counted once.

#include "tactum/response/constraint_state.h"

namespace tactum::inline v0_1 {

/// The displacement of the handle that the coupling asks for in this frame, world axes, (m, rad).
Vec6 wanted_by_hand(const ConstraintStep& step, const HandInput& hand) noexcept;
/// Sets CoupledHand::wanted of every hand that holds a part.
void find_wanted(ConstraintStep& step) noexcept;
/// Adds the part that `body` is to a contact problem: the couplings of the hands that hold it over one frame,
/// and its damping, are its metric; its target is where they would have it with weight, force fields and its
/// load, each asking for `share` of CoupledHand::wanted.
void add_grasped(int body, double share, const ConstraintStep& step, ContactProblem& problem) noexcept;
/// The same with the target where the part is.
void add_grasped_at_rest(int body, const ConstraintStep& step, ContactProblem& problem) noexcept;
/// Sets CoupledHand::felt of every hand that holds a part to the wrench that it feels in the problem's last
/// answer.
void feel_answer(const ContactProblem& problem, ConstraintStep& step) noexcept;
/// Adds the torque of a friction force about its normal, which acts on the first body of a pair and turns the
/// other one back, to CoupledHand::torque of the hands that hold one of them.
void add_friction_torque(const SurfacePair& pair, const Vec3& torque_W, ConstraintStep& step) noexcept;
/// The same as feel_answer() when the parts stay where they are.
void feel_standing(ConstraintStep& step) noexcept;

}  // namespace tactum::inline v0_1
