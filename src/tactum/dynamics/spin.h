#pragma once
/// The rotation of a body without contact: its angular momentum is constant, its axis moves.
///
/// Over a step of h seconds it turns by the rate it has midway, w = I(R_mid)^-1 L, which keeps L to the bit
/// and its energy to the second order of h.

#include "tactum/dynamics/world.h"
#include "tactum/math/screw.h"

namespace tactum::inline v0_1 {

/// Whether a body has a rotation of its own: it is free, or hangs on a ball.
bool turns_freely(const Body& body) noexcept;

/// Inertia of such a body about the point it turns about, the centre of mass or its ball, axes of B.
Mat3 turning_inertia(const Body& body) noexcept;

/// Inertia about world axes at an orientation.
inline Mat3 inertia_at(const Mat3& inertia_B, const Mat3& R_WB) {
  return R_WB * inertia_B * R_WB.transpose();
}

/// The rate midway through a step that begins with rate `w_WB` at R_WB [rad/s].
Vec3 rate_midway(const Mat3& inertia_B, const Mat3& R_WB, const Vec3& w_WB, double h) noexcept;

/// The rate at the end of a step from R_WB to R_WB_end that began with rate `w_WB` and was pushed by
/// `impulse`, an angular momentum [N m s].
Vec3 rate_after(const Mat3& inertia_B, const Mat3& R_WB, const Vec3& w_WB, const Vec3& impulse,
                const Mat3& R_WB_end) noexcept;

}  // namespace tactum::inline v0_1
