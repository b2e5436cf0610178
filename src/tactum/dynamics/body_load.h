#pragma once
/// How a body moves under its weight and its load (world.h) while nothing touches it, and how it resists the
/// impulse of a contact meanwhile. With M its inertia, D its damping, W weight, constant force and torque, a
/// step of h seconds is
///
///     (M + a h D) V_1 = (M - (1 - a) h D) V_0 + h W,     a = 1 / (1 - e^-x) - 1 / x,     x = h |M^-1 D|,
///
/// projected on the motions that the joint leaves free. Where all of these fade at one rate, as for a body on
/// a hinge, that is the exact answer: speeds fade as e^-x, and the last speed under a constant force is the
/// force over the damping at every step. Where they fade at several rates, x is that of the fastest: each is
/// then right to the second order of h, and no step turns a speed round. M + a h D is also the resistance
/// that an impulse meets which is spread over the step.

#include "tactum/dynamics/contact_problem.h"

namespace tactum::inline v0_1 {

/// The fastest rate at which the body's damping alone makes a motion of its fade; 0 without damping [1/s].
double fastest_fading(const Body& body, const Pose& X_WB) noexcept;

/// The inertia, and what damping adds to it over a step of `h` seconds.
Resistance damped_resistance(const Body& body, const Pose& X_WB, double h) noexcept;

/// The same as the metric of a step of `h` seconds, at the origin.
BodyMetric damped_metric(const Body& body, const Pose& X_WB, double h) noexcept;

/// The velocity after `h` seconds at X_WB under weight and load, as if there were no joint; the one that the
/// joint allows is the nearest in damped_resistance(). A negative `h`, of no more than some times
/// 1 / fastest_fading(), leads back.
Twist driven_velocity(const Body& body, const Vec3& gravity_W, const Pose& X_WB, const Twist& V_WB,
                      double h) noexcept;

/// The largest change of velocity that the load gives the body in `h` seconds, as its joint allows.
Twist most_by_load(const Body& body, const Pose& X_WB, double h) noexcept;

/// The work of all loads on the bodies in a step of `h` seconds from the first poses to the second; that of
/// damping is negative [J].
double work_of_loads(const World& world, std::span<const Pose> from, std::span<const Pose> to,
                     double h) noexcept;

}  // namespace tactum::inline v0_1
