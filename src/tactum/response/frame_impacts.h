#pragma once
/// The impacts of a frame, between the two halves of weight and load (free_bodies.h).
///
/// Impacts see the velocities that bodies have, not those of their weight alone: what rests on a floor is at
/// rest while something falls on it. So the forces of resting contacts act on in the motion that impacts see
/// as they were in the last frame, and are taken out again afterwards, for this frame's contacts to be found.

#include "tactum/response/constraint_state.h"

namespace tactum::inline v0_1 {

/// Applies the impacts to the velocities and detours of all bodies but the grasped ones, which feel them.
void apply_impacts(ConstraintStep& step) noexcept;

// The motion of bodies that nothing touches, and how a motion opens a contact.

/// Drives the velocity by weight and load for `h` seconds, as far as the joint lets them act.
void drive(const Body& body, const Vec3& gravity_W, double h, const Pose& X_WB, Twist& V_WB) noexcept;

/// The displacement [m], or velocity [m/s], by which a motion of its two bodies opens a row.
double opening(const ContactRow& row, const Twist& of_a, const Twist& of_b,
               const ConstraintStep& step) noexcept;

inline bool is_zero(const Twist& displacement) noexcept {
  return displacement.v.isZero(0.0) && displacement.w.isZero(0.0);
}

}  // namespace tactum::inline v0_1
