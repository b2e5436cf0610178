#pragma once
/// Twists and wrenches: a velocity and a force, each with its turning part, and their change between frames.
///
/// A Twist V_WB is the velocity of B's origin and the angular velocity of B, both with axes of W.
/// A Wrench F_W acts at a named reference point (mostly the body's centre of mass), with axes of W.

#include "tactum/math/pose.h"

namespace tactum::inline v0_1 {

struct Twist {
  Vec3 v = Vec3::Zero();  ///< linear, of the reference point [m/s]
  Vec3 w = Vec3::Zero();  ///< angular [rad/s]

  Twist operator+(const Twist& b) const { return {v + b.v, w + b.w}; }
  Twist operator-(const Twist& b) const { return {v - b.v, w - b.w}; }
  Twist operator*(double s) const { return {v * s, w * s}; }
  bool finite() const { return v.allFinite() && w.allFinite(); }
};

struct Wrench {
  Vec3 f = Vec3::Zero();  ///< force [N]
  Vec3 t = Vec3::Zero();  ///< torque about the reference point [N m]

  Wrench operator+(const Wrench& b) const { return {f + b.f, t + b.t}; }
  Wrench operator-(const Wrench& b) const { return {f - b.f, t - b.t}; }
  Wrench operator*(double s) const { return {f * s, t * s}; }
  bool finite() const { return f.allFinite() && t.allFinite(); }
};

/// The same motion stated at a point `r` away (same axes).
inline Twist moved(const Twist& V, const Vec3& r) { return {V.v + V.w.cross(r), V.w}; }

/// The same load stated at a point `r` away (same axes).
inline Wrench moved(const Wrench& F, const Vec3& r) { return {F.f, F.t - r.cross(F.f)}; }

/// The same motion with axes of A instead of B.
inline Twist rotated(const Mat3& R_AB, const Twist& V) { return {R_AB * V.v, R_AB * V.w}; }
/// The same load with axes of A instead of B.
inline Wrench rotated(const Mat3& R_AB, const Wrench& F) { return {R_AB * F.f, R_AB * F.t}; }

/// Velocity of the point at `r` from the twist's reference point.
inline Vec3 velocity_at(const Twist& V, const Vec3& r) { return V.v + V.w.cross(r); }

/// Power of the load on the motion [W]; both at the same reference point.
inline double power(const Wrench& F, const Twist& V) { return F.f.dot(V.v) + F.t.dot(V.w); }

}  // namespace tactum::inline v0_1
