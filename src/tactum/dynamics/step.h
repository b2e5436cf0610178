#pragma once
/// The step of a frame as published: find the smallest time of impact, advance everything to it, apply the
/// contact forces, advance with the new velocities for the rest of the frame [Gregory 2000, 6.1].

#include <span>

#include "tactum/dynamics/contact_row.h"
#include "tactum/dynamics/joint.h"

namespace tactum::inline v0_1 {

/// When the contact closes, from distance and closing speed, in [0, dt]; 0 when it overlaps or touches, dt
/// when it does not close by then.
double time_of_closing(const ContactRow& row, std::span<const Pose> X_WB, std::span<const Twist> V,
                       double dt) noexcept;

/// Moves the distances of the rows as the bodies move: d += vn t.
void advance_distances(std::span<ContactRow> rows, std::span<const Pose> X_WB, std::span<const Twist> V,
                       double t) noexcept;

/// Moves every body with its twist for `t` seconds.
void advance_bodies(const World& world, std::span<const Twist> V, double t, std::span<Pose> X_WB) noexcept;

}  // namespace tactum::inline v0_1
